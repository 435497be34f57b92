"""NSNS: double Neimark-Sacker point."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="NSNS", words="double Neimark-Sacker point", codimension=2, on=("NS",),
    also="double torus (TTR)",
    condition="multipliers exp(+-i theta1) and exp(+-i theta2)",
    source=f"{MAPS}; {CYCLES_TWO}",
    curves=("NS", "NS"),
    points={"NS": Sign(7, 2)}, orbits={"NS": 2}, flows=False, maps=True,
    marker="*", symbol="star",
)  # fmt: skip
