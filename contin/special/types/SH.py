"""SH: Shilnikov-Hopf point."""

from contin.special.sources import HOMOCLINIC
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="SH", words="Shilnikov-Hopf point", codimension=2, on=("HOM",),
    also="homoclinic orbit to a Hopf point",
    condition="a pair of eigenvalues of the saddle is imaginary",
    source=HOMOCLINIC,
    marker="o", symbol="circle",
)  # fmt: skip
