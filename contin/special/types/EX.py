"""EX: extremum."""

from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="EX", words="extremum", many="extrema", codimension=0,
    on=("equilibrium", "fixed-point", "orbit", "algebraic", "bvp"),
    also="limit point of a functional",
    condition="a column has a largest or smallest value along the branch", critical=0,
    births=("point_EX_to_extrema", "bvp_EX_to_extrema", "orbit_EX_to_extrema", "locus_EX_to_extrema"),
    marker="o", symbol="circle",
)  # fmt: skip
