"""GH: generalised Hopf (Bautin) point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="GH", words="generalised Hopf (Bautin) point", codimension=2, on=("HB",),
    also="Bautin point, degenerate Hopf, generalized Hopf",
    condition="HB with l1 = 0",
    source=f"{KUZNETSOV}, sec. 8.3",
    normal_form="contin.normalforms.hopf:generalised_hopf", needs=("frequency",), order=5,
    births=("GH_to_folds_of_cycles", "locus_to_curves_in_three_parameters"),
    curves=("HB",),
    points={"HB": Sign(5, 0)},
    marker="P", symbol="plus",
)  # fmt: skip
