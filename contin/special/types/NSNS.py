"""NSNS: double Neimark-Sacker point."""

from contin.special.sources import CYCLES_TWO, INTERACTING
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="NSNS", words="double Neimark-Sacker point", codimension=2, on=("NS",),
    also="double torus (TTR)",
    condition="multipliers exp(+-i theta1) and exp(+-i theta2)",
    source=f"{INTERACTING}; {CYCLES_TWO}",
    normal_form="contin.normalforms.two_amplitudes:double_neimark_sacker", order=3,
    curves=("NS", "NS"),
    points={"NS": Sign(7, 2)}, orbits={"NS": 2}, flows=False, maps=True,
    marker="*", symbol="star",
)  # fmt: skip
