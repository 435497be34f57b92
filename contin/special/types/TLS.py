"""TLS: three leading eigenvalues, stable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="TLS", words="three leading eigenvalues, stable side",
    many="points with three leading eigenvalues, stable side", codimension=2, on=("HOM",),
    also="3LS (MatCont), IPSI 7 (AUTO)",
    condition="a stable pair and a real eigenvalue, both leading, have one real part",
    source=HOMOCLINIC,
    connections=10,
    marker="p", symbol="pentagon",
)  # fmt: skip
