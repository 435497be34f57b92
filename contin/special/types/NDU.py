"""NDU: neutrally divergent saddle-focus, unstable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NDU", words="neutrally divergent saddle-focus, unstable side",
    many="neutrally divergent saddle-foci, unstable side", codimension=2, on=("HOM",),
    also="NDU (MatCont), IPSI 6 (AUTO)",
    condition="the leading unstable pair and the leading stable eigenvalue have zero sum of real parts",
    source=HOMOCLINIC,
    connections=9,
    marker="D", symbol="diamond",
)  # fmt: skip
