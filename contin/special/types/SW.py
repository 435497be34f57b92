"""SW: swallowtail."""

from contin.special.sources import SINGULARITIES
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="SW", words="swallowtail", codimension=3, on=("CP",),
    condition="CP with c = 0",
    source=f"{SINGULARITIES}, ch. IV",
    marker="<", symbol="triangle-left",
)  # fmt: skip
