"""DP: degenerate branch point."""

from contin.special.sources import SINGULARITIES
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="DP", words="degenerate branch point", codimension=2, on=("BP",),
    condition="BP whose transcritical or pitchfork coefficient vanishes",
    source=f"{SINGULARITIES}, ch. II",
    curves=("LP", "BP"),
    points={"BP": Sign(2, 0)}, maps=True,
    births=("locus_to_degenerate_points_in_three_parameters",),
    marker="d", symbol="thin-diamond",
)  # fmt: skip
