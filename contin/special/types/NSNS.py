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
    modes=((), 2),
    powers={"p11": (2, 0), "p12": (0, 2), "p21": (2, 0), "p22": (0, 2)}, ratios={"theta": "p22", "delta": "p11"},
    marker="*", symbol="star",
)  # fmt: skip
