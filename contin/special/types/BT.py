"""BT: Bogdanov-Takens point."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import Sign, SpecialType

TYPE = SpecialType(
    code="BT", words="Bogdanov-Takens point", codimension=2, on=("LP", "HB", "BP"),
    also="Takens-Bogdanov, double zero",
    condition="two zero eigenvalues, one eigenvector",
    source=f"{KUZNETSOV}, sec. 8.4",
    normal_form="contin.normalforms.bogdanov_takens:bogdanov_takens", needs=("state_error",), order=3,
    births=("BT_to_homoclinic", "locus_to_curves_in_three_parameters"),
    curves=("LP", "HB"),
    points={"LP": Sign(3, 1), "HB": Sign(2, 0), "BP": Sign(3, 1)},
    marker="h", symbol="hexagon",
)  # fmt: skip
