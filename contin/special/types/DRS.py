"""DRS: Belyakov point, stable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="DRS", words="Belyakov point, stable side",
    many="Belyakov points, stable side", codimension=2, on=("HOM",),
    also="saddle to saddle-focus; DRS (MatCont), IPSI 2 (AUTO)",
    condition="the two leading stable eigenvalues are real and alike, complex beyond",
    source=HOMOCLINIC,
    connections=6,
    marker="H", symbol="hexagon2",
)  # fmt: skip
