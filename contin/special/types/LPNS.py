"""LPNS: fold-Neimark-Sacker point."""

from contin.special.sources import CYCLES_TWO, INTERACTING
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="LPNS", words="fold-Neimark-Sacker point", codimension=2, on=("LP", "BP", "NS", "LPC", "BPC"),
    also="fold-torus (LTR)",
    condition="multipliers 1 and exp(+-i theta)",
    source=f"{INTERACTING}; {CYCLES_TWO}",
    normal_form="contin.normalforms.fold_neimark_sacker:fold_neimark_sacker", needs=("state_error",), order=3,
    curves=("LP", "NS"),
    points={"LP": Sign(4, 2), "BP": Sign(4, 2), "NS": Sign(4, 1)}, orbits={"LPC": 2, "BPC": 2, "NS": 4}, flows=False,
    maps=True,
    modes=((1.0,), 1),
    powers={"f200": (1, 0), "f011": (-1, 2), "g110": (1, 0)},
    ratios={"a": "f200", "b": "f200", "c": "f200", "theta": "f200", "E": "f200"},
    marker="X", symbol="saltire",
)  # fmt: skip
