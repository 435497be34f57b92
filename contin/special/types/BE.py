"""BE: boundary equilibrium."""

from contin.special.sources import PIECEWISE
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="BE", words="boundary equilibrium", codimension=1, on=("equilibrium",),
    also="border collision",
    condition="f = 0 on a surface across which f jumps",
    source=f"{PIECEWISE}, sec. 5.2",
    births=("equilibrium_BE_to_sliding",),
    marker="H", symbol="hexagon",
)  # fmt: skip
