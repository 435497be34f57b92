"""CPC: cusp of cycles."""

from contin.special.sources import CYCLES_TWO
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="CPC", words="cusp of cycles", many="cusps of cycles", codimension=2, on=("LPC",),
    condition="LPC whose quadratic coefficient b vanishes",
    source=CYCLES_TWO,
    orbits={"LPC": 5},
    normal_form="contin.normalforms.fold:cusp", order=3,
    powers={"c": 2}, rate=1.0,
    marker="v", symbol="triangle-down",
)  # fmt: skip
