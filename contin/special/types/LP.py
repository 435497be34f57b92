"""LP: fold."""

from contin.special.sources import KUZNETSOV
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="LP", words="fold", codimension=1, on=("equilibrium", "fixed-point", "algebraic", "bvp", "connection"),
    also="limit point, turning point, saddle-node",
    condition="f = 0, f_u v = 0 (maps: f_u v = v), the parameter turns: <w, f_p> != 0", critical=1,
    source=f"{KUZNETSOV}, sec. 3.2",
    normal_form="contin.normalforms.fold:fold", needs=("state_error",), order=3,
    births=("point_to_locus", "equilibrium_of_large_to_locus", "bvp_to_locus", "connection_LP_to_locus"),
    curves=("LP",), cycle="LPC",
    branch=0, maps=True,
    marker="s", symbol="square", colour=0,
)  # fmt: skip
