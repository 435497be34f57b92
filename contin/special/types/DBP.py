"""DBP: degenerate branch point."""

from contin.special.sources import SINGULARITIES
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="DBP", words="degenerate branch point", codimension=3, on=("BP",),
    condition="BP whose reduced equation has a02 b20 = b11^2, or b20 = 0",
    source=f"{SINGULARITIES}, ch. IV",
    marker="s", symbol="square",
)  # fmt: skip
