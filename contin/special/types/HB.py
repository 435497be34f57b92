"""HB: Hopf point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="HB", words="Hopf point", codimension=1, on=("equilibrium",),
    also="Andronov-Hopf, Poincare-Andronov-Hopf",
    condition="f = 0, (f_u - i omega) q = 0, omega > 0", critical=2,
    source=f"{KUZNETSOV}, sec. 3.4",
    normal_form="contin.normalforms.hopf:hopf", needs=("frequency",), order=3,
    births=("equilibrium_HB_to_orbits", "point_to_locus", "equilibrium_of_large_to_locus"),
    curves=("HB",),
    branch=2,
    marker="o", symbol="circle", colour=1,
)  # fmt: skip
