"""NSS: resonance of real leading eigenvalues."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NSS", words="resonance of real leading eigenvalues", many="resonances of real leading eigenvalues",
    codimension=2, on=("HOM",),
    also="resonant eigenvalues of the saddle",
    condition="the leading eigenvalues of the saddle have zero sum",
    source=HOMOCLINIC,
    connections=0,
    marker="<", symbol="triangle-left",
)  # fmt: skip
