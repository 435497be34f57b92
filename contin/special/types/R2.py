"""R2: 1:2 resonance."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="R2", words="1:2 resonance", codimension=2, on=("PD", "NS"),
    also="double multiplier -1",
    condition="a double multiplier -1, one eigenvector",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:resonance_1_2", order=3,
    curves=("PD", "NS"),
    points={"PD": Sign(3, 1), "NS": Sign(3, 0)}, orbits={"PD": 3, "NS": 6}, cosine=-1.0, flows=False, maps=True,
    powers={"C": 2, "D": 2, "C1": 2, "D1": 2},
    marker=">", symbol="triangle-right",
)  # fmt: skip
