"""CH: Chenciner point."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="CH", words="Chenciner point", codimension=2, on=("NS",),
    also="generalized Neimark-Sacker, degenerate torus",
    condition="NS with Re d = 0",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:chenciner", needs=("frequency",), order=5,
    curves=("NS",),
    points={"NS": Sign(6, 0)}, orbits={"NS": 9}, flows=False, maps=True,
    powers={"l2": 4}, rate=1.0,
    marker="P", symbol="plus",
)  # fmt: skip
