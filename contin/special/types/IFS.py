"""IFS: inclination flip, stable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="IFS", words="inclination flip, stable side", many="inclination flips, stable side", codimension=2,
    on=("HOM",),
    condition="the adjoint solution decays along a stronger direction forward in time",
    source=HOMOCLINIC,
    connections=4,
    marker="P", symbol="plus",
)  # fmt: skip
