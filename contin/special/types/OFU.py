"""OFU: orbit flip, unstable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="OFU", words="orbit flip, unstable side", many="orbit flips, unstable side", codimension=2, on=("HOM",),
    condition="the orbit leaves along a stronger direction than the leading one",
    source=HOMOCLINIC,
    connections=3,
    marker="v", symbol="triangle-down",
)  # fmt: skip
