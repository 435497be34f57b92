"""LPC: fold of cycles."""

from contin.special.sources import CYCLES
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="LPC", words="fold of cycles", many="folds of cycles", codimension=1, on=("orbit",),
    also="limit point of cycles, saddle-node of cycles, cyclic fold",
    condition="a second multiplier 1, the parameter turns", critical=1,
    source=CYCLES,
    births=("orbit_to_locus", "orbit_by_shooting_to_locus", "orbit_of_large_to_locus", "hybrid_orbit_to_locus"),
    curves=("LPC",),
    branch=0,
    marker=">", symbol="triangle-right", colour=5, dashes=(4, 1.3),
)  # fmt: skip
