"""LPPD: fold-flip point."""

from contin.special.sources import CYCLES_TWO, FOLD_FLIP
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="LPPD", words="fold-flip point", codimension=2, on=("LP", "BP", "PD", "LPC", "BPC"),
    also="(LPD)",
    condition="multipliers 1 and -1",
    source=f"{FOLD_FLIP}; {CYCLES_TWO}",
    normal_form="contin.normalforms.fold_flip:fold_flip", needs=("state_error",), order=3,
    curves=("LP", "PD"),
    points={"LP": Sign(5, 1), "BP": Sign(5, 1), "PD": Sign(5, 1)}, orbits={"LPC": 3, "BPC": 3, "PD": 4}, flows=False,
    maps=True,
    modes=((1.0, -1.0), 0),
    powers={"e": (1, 0), "b": (0, 2), "d": (0, 2), "L_NS": (0, 2)}, ratios={"a": "e", "c": "e"},
    marker="8", symbol="octagon",
)  # fmt: skip
