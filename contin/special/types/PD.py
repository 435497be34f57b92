"""PD: period doubling."""

from contin.special.sources import CYCLES, KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="PD", words="period doubling", many="period doublings", codimension=1, on=("fixed-point", "orbit"),
    also="flip",
    condition="a multiplier -1", critical=1,
    source=f"{KUZNETSOV}, sec. 4.4; {CYCLES}",
    normal_form="contin.normalforms.maps:period_doubling", order=3,
    births=(
        "map_PD_to_doubled", "orbit_PD_to_doubled", "orbit_PD_to_doubled_by_shooting", "orbit_of_large_to_orbits",
        "orbit_PD_BPC_to_hybrid_orbits",
        "point_to_locus",
        "orbit_to_locus", "orbit_by_shooting_to_locus", "orbit_of_large_to_locus", "hybrid_orbit_to_locus",
    ),
    curves=("PD",), continues=("fixed-point", "orbit"),
    branch=3, maps=True,
    marker="^", symbol="triangle-up", colour=3, dashes=(2.2, 1.0),
)  # fmt: skip
