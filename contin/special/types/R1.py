"""R1: 1:1 resonance."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="R1", words="1:1 resonance", codimension=2, on=("LP", "BP", "NS", "LPC", "BPC"),
    also="double multiplier 1",
    condition="a double multiplier 1 (beside the trivial one), one eigenvector",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:resonance_1_1", order=2,
    curves=("LP", "NS"),
    points={"LP": Sign(3, 1), "BP": Sign(3, 1), "NS": Sign(2, 0)}, orbits={"LPC": 4, "BPC": 4, "NS": 5}, cosine=1.0,
    flows=False, maps=True,
    powers={"a": 1, "b": 1},
    marker="<", symbol="triangle-left",
)  # fmt: skip
