"""DRU: Belyakov point, unstable side."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="DRU", words="Belyakov point, unstable side",
    many="Belyakov points, unstable side", codimension=2, on=("HOM",),
    also="saddle to saddle-focus; DRU (MatCont), IPSI 3 (AUTO)",
    condition="the two leading unstable eigenvalues are real and alike, complex beyond",
    source=HOMOCLINIC,
    connections=7,
    marker="h", symbol="hexagon",
)  # fmt: skip
