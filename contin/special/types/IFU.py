"""IFU: inclination flip, unstable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="IFU", words="inclination flip, unstable side", many="inclination flips, unstable side", codimension=2,
    on=("HOM",),
    condition="the adjoint solution decays along a stronger direction backward in time",
    source=HOMOCLINIC,
    connections=5,
    marker="X", symbol="saltire",
)  # fmt: skip
