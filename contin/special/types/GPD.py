"""GPD: generalised period doubling."""

from contin.special.sources import CYCLES_TWO, MAPS
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="GPD", words="generalised period doubling", codimension=2, on=("PD",),
    also="generalized flip, degenerate flip",
    condition="PD with c = 0",
    source=f"{MAPS}; {CYCLES_TWO}",
    normal_form="contin.normalforms.map_resonances:generalised_flip", order=5,
    births=("GPD_to_folds_of_doubled",),
    curves=("PD",),
    points={"PD": Sign(2, 0)}, orbits={"PD": 5}, flows=False, maps=True,
    powers={"e": 4}, rate=-1.0,
    marker="H", symbol="hexagon",
)  # fmt: skip
