"""HOM: homoclinic orbit."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="HOM", words="homoclinic orbit", codimension=1, on=("orbit",),
    also="saddle loop, infinite-period bifurcation",
    condition="the period diverges towards a saddle, or a saddle-node",
    source=HOMOCLINIC,
    births=("orbit_HOM_to_glued", "orbit_HOM_to_locus"),
    curves=("HOM",),
    marker="*", symbol="star", colour=6,
)  # fmt: skip
