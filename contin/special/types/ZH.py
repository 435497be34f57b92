"""ZH: zero-Hopf point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="ZH", words="zero-Hopf point", codimension=2, on=("LP", "HB", "BP"),
    also="fold-Hopf, saddle-node Hopf, Gavrilov-Guckenheimer",
    condition="eigenvalues 0 and +-i omega",
    source=f"{KUZNETSOV}, sec. 8.5",
    normal_form="contin.normalforms.zero_hopf:zero_hopf", needs=("frequency", "state_error"), order=3,
    births=("ZH_to_tori", "locus_to_curves_in_three_parameters"),
    curves=("LP", "HB"),
    points={"LP": Sign(4, 2), "HB": Sign(3, 1), "BP": Sign(4, 2)},
    marker="8", symbol="octagon",
)  # fmt: skip
