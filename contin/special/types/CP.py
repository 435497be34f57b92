"""CP: cusp."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="CP", words="cusp", codimension=2, on=("LP",),
    also="hysteresis point",
    condition="LP with <w, B(v, v)> = 0",
    source=f"{KUZNETSOV}, sec. 8.2",
    normal_form="contin.normalforms.fold:cusp", order=3,
    curves=("LP",),
    points={"LP": Sign(2, 0)}, maps=True,
    births=("locus_to_curves_in_three_parameters", "locus_to_degenerate_points_in_three_parameters"),
    marker="v", symbol="triangle-down",
)  # fmt: skip
