"""NDS: neutrally divergent saddle-focus, stable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NDS", words="neutrally divergent saddle-focus, stable side",
    many="neutrally divergent saddle-foci, stable side", codimension=2, on=("HOM",),
    also="NDS (MatCont), IPSI 5 (AUTO)",
    condition="the leading stable pair and the leading unstable eigenvalue have zero sum of real parts",
    source=HOMOCLINIC,
    connections=8,
    marker="d", symbol="diamond-tall",
)  # fmt: skip
