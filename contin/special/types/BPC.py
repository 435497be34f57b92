"""BPC: branch point of cycles."""

from contin.special.sources import CYCLES
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="BPC", words="branch point of cycles", many="branch points of cycles", codimension=1, on=("orbit",),
    also="branching point of cycles",
    condition="a second multiplier 1, another family crosses",
    source=CYCLES,
    births=(
        "orbit_BPC_to_crossing", "orbit_BPC_to_crossing_by_shooting", "orbit_of_large_to_orbits",
        "orbit_PD_BPC_to_hybrid_orbits",
        "orbit_to_locus", "orbit_by_shooting_to_locus", "orbit_of_large_to_locus", "hybrid_orbit_to_locus",
        "orbit_BPC_to_curve_in_three_parameters",
    ),
    curves=("BPC",), continues=("orbit",),
    branch=1,
    marker="d", symbol="thin-diamond", colour="#8C564B", dashes=(7, 1.5, 1.5, 1.5),
)  # fmt: skip
