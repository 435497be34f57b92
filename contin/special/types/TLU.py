"""TLU: three leading eigenvalues, unstable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="TLU", words="three leading eigenvalues, unstable side",
    many="points with three leading eigenvalues, unstable side", codimension=2, on=("HOM",),
    also="3LU (MatCont), IPSI 8 (AUTO)",
    condition="an unstable pair and a real eigenvalue, both leading, have one real part",
    source=HOMOCLINIC,
    connections=11,
    marker="P", symbol="cross-thin",
)  # fmt: skip
