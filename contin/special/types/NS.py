"""NS: Neimark-Sacker point."""

from contin.special.sources import CYCLES, KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="NS", words="Neimark-Sacker point", codimension=1, on=("fixed-point", "orbit"),
    also="torus bifurcation (TR), secondary Hopf",
    condition="multipliers exp(+-i theta), 0 < theta < pi", critical=2,
    source=f"{KUZNETSOV}, sec. 4.7; {CYCLES}",
    normal_form="contin.normalforms.maps:neimark_sacker", needs=("frequency",), order=3,
    births=(
        "point_to_locus", "orbit_to_locus", "orbit_by_shooting_to_locus", "orbit_of_large_to_locus",
        "hybrid_orbit_to_locus",
    ),
    curves=("NS",),
    branch=2, maps=True,
    marker="p", symbol="pentagon", colour=4, dashes=(3.5, 1.2, 1.0, 1.2),
)  # fmt: skip
