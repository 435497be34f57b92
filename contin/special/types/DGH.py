"""DGH: degenerate generalised Hopf point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="DGH", words="degenerate generalised Hopf point", codimension=3, on=("GH",),
    condition="GH with l2 = 0",
    source=f"{KUZNETSOV}, sec. 8.7",
    marker="P", symbol="plus",
)  # fmt: skip
