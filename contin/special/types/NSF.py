"""NSF: resonance of a pair and a real eigenvalue."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NSF", words="resonance of a pair and a real eigenvalue", many="resonances of a pair and a real eigenvalue",
    codimension=2, on=("HOM",),
    condition="leading pair and leading real eigenvalue have zero sum",
    source=HOMOCLINIC,
    marker=">", symbol="triangle-right",
)  # fmt: skip
