"""DBT: degenerate Bogdanov-Takens point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="DBT", words="degenerate Bogdanov-Takens point", codimension=3, on=("BT",),
    condition="BT with a = 0 or b = 0",
    source=f"{KUZNETSOV}, sec. 8.7",
    marker="H", symbol="hexagon",
)  # fmt: skip
