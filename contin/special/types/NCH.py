"""NCH: non-central saddle-node homoclinic orbit."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NCH", words="non-central saddle-node homoclinic orbit", codimension=2, on=("HOM",),
    condition="an eigenvalue of the saddle vanishes and the orbit leaves its centre manifold",
    source=HOMOCLINIC,
    births=("NCH_to_homoclinic",),
    connections=1,
    marker="s", symbol="square",
)  # fmt: skip
