"""UZ: user value."""

from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="UZ", words="user value", many="isoperiodic orbits", codimension=0,
    on=("equilibrium", "fixed-point", "orbit", "algebraic", "bvp"),
    also="user zero",
    condition="a column has a value that the user named", critical=0,
    births=("orbit_to_locus", "orbit_by_shooting_to_locus"),
    marker="x", symbol="cross", quiet=True,
)  # fmt: skip
