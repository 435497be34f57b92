"""OFS: orbit flip, stable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="OFS", words="orbit flip, stable side", many="orbit flips, stable side", codimension=2, on=("HOM",),
    condition="the orbit arrives along a stronger direction than the leading one",
    source=HOMOCLINIC,
    connections=2,
    marker="^", symbol="triangle-up",
)  # fmt: skip
