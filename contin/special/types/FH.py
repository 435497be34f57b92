"""FH: further pair of imaginary eigenvalues."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="FH", words="further pair of imaginary eigenvalues", many="further pairs of imaginary eigenvalues",
    codimension=3, on=("CP", "BT", "GH", "ZH", "HH", "BP"),
    condition="a further pair of eigenvalues is imaginary",
    source=f"{KUZNETSOV}, sec. 8.7",
    marker="h", symbol="octagon",
)  # fmt: skip
