"""PDNS: flip-Neimark-Sacker point."""

from contin.special.sources import CYCLES_TWO, INTERACTING
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="PDNS", words="flip-Neimark-Sacker point", codimension=2, on=("PD", "NS"),
    also="flip-torus (PTR)",
    condition="multipliers -1 and exp(+-i theta)",
    source=f"{INTERACTING}; {CYCLES_TWO}",
    normal_form="contin.normalforms.two_amplitudes:flip_neimark_sacker", order=3,
    curves=("PD", "NS"),
    points={"PD": Sign(4, 2), "NS": Sign(5, 1)}, orbits={"PD": 2, "NS": 3}, flows=False, maps=True,
    modes=((-1.0,), 1),
    powers={"p11": (2, 0), "p12": (0, 2), "p21": (2, 0), "p22": (0, 2)}, ratios={"theta": "p22", "delta": "p11"},
    marker="d", symbol="thin-diamond",
)  # fmt: skip
