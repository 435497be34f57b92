"""FZ: further zero eigenvalue."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="FZ", words="further zero eigenvalue", codimension=3, on=("GH", "ZH", "HH", "BP"),
    condition="a further eigenvalue is zero",
    source=f"{KUZNETSOV}, sec. 8.7",
    marker="H", symbol="hexagon",
)  # fmt: skip
