"""R3: 1:3 resonance."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="R3", words="1:3 resonance", codimension=2, on=("NS",),
    condition="NS with theta = 2 pi/3",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:resonance_1_3", order=3,
    points={"NS": Sign(8, 0)}, orbits={"NS": 7}, cosine=-0.5, flows=False, maps=True,
    powers={"B": 1, "B1": 1, "C": 2, "C1": 2}, ratios={"a": "B1"},
    marker="1", symbol="tri-down", quiet=True,
)  # fmt: skip
