"""TZ: triple zero."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="TZ", words="triple zero", codimension=3, on=("LP", "HB", "BP", "BT"),
    condition="three zero eigenvalues",
    source=f"{KUZNETSOV}, sec. 8.7",
    marker="H", symbol="hexagon",
)  # fmt: skip
