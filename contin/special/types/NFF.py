"""NFF: resonance of two pairs."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NFF", words="resonance of two pairs", many="resonances of two pairs", codimension=2, on=("HOM",),
    condition="both leading pairs have zero sum of real parts",
    source=HOMOCLINIC,
    marker="1", symbol="tri-down",
)  # fmt: skip
