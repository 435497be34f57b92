"""HH: double Hopf point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="HH", words="double Hopf point", codimension=2, on=("HB",),
    also="Hopf-Hopf, two pairs of imaginary eigenvalues",
    condition="eigenvalues +-i omega1 and +-i omega2",
    source=f"{KUZNETSOV}, sec. 8.6",
    normal_form="contin.normalforms.hopf_hopf:hopf_hopf", order=3,
    births=("HH_to_tori", "locus_to_curves_in_three_parameters"),
    curves=("HB", "HB"),
    points={"HB": Sign(4, 2)},
    marker="X", symbol="saltire",
)  # fmt: skip
