"""R4: 1:4 resonance."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="R4", words="1:4 resonance", codimension=2, on=("NS",),
    condition="NS with theta = pi/2",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:resonance_1_4", order=3,
    points={"NS": Sign(9, 0)}, orbits={"NS": 8}, cosine=0.0, flows=False, maps=True,
    powers={"C": 2, "D": 2, "C1": 2, "D1": 2}, ratios={"A0": "D1"},
    marker="2", symbol="tri-up", quiet=True,
)  # fmt: skip
