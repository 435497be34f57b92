"""BP: branch point."""

from contin.special.sources import KUZNETSOV, SINGULARITIES
from contin.special.special_type import SpecialType

TYPE = SpecialType(
    code="BP", words="branch point", codimension=1, on=("equilibrium", "fixed-point", "algebraic", "bvp"),
    also="branching point, transcritical, pitchfork, symmetry breaking",
    condition="f = 0, rank [f_u | f_p] = n - 1: another branch crosses", critical=1,
    source=f"{KUZNETSOV}, sec. 7.4; {SINGULARITIES}",
    normal_form="contin.normalforms.directions:any_branch_point", needs=("kernel", "state_error"), order=3,
    births=(
        "equilibrium_BP_to_branches",
        "equilibrium_BP_to_sparse_branches",
        "bvp_BP_to_crossing",
        "point_to_locus",
        "equilibrium_BP_to_curves_in_three_parameters",
        "bvp_to_locus",
    ),
    curves=("BP",), continues=("equilibrium", "fixed-point", "algebraic", "bvp"), cycle="BPC",
    branch=1, maps=True,
    marker="D", symbol="diamond", colour=2, dashes=(7, 1.5),
)  # fmt: skip
