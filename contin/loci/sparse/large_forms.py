"""Normal forms from centre manifolds of systems too large for dense methods."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.abi import Array
from contin.loci.sparse.large_manifold import LargeJet, LargeManifold, Solves, pair_of
from contin.normalforms.hopf import conjugate, generalised_hopf_on
from contin.normalforms.result import NotThisTypeError
from contin.problems.sparse.forms import Derivatives, with_errors
from contin.records import Fields

if TYPE_CHECKING:
    from contin.loci.sparse.on_large_curve import OnLargeCurve

DENSE: Final = 400  # unknowns up to which dense linear algebra takes a second at most


def large_form(problem: OnLargeCurve, type_: str, z: Array, known: Fields) -> Fields:
    """Coefficients of a GH, as the dense methods have them, and the error of l2: how far it scatters as forms do."""
    if type_ != "GH":
        raise NotThisTypeError(f"beyond {DENSE} unknowns there are those of CP, BT and GH")
    branch, point = problem.curve.branch(z)
    linear = problem.curve.linear_at(z)
    first = pair_of(linear, 1j * known["omegas"][0], known["pairs"][0])
    pairs, solves = [first, conjugate(first)], Solves(linear)

    def manifold(form: Derivatives) -> LargeManifold:
        return LargeManifold(LargeJet(form, linear), pairs, solves)

    exact = manifold(Derivatives(branch, point))

    def coefficients(form: Derivatives) -> dict[str, float]:
        made = exact if form.noise is None and form.system is None else manifold(form)
        return {"l2": made.g((3, 2), 0).real}

    _, errors = with_errors(branch, point, coefficients)
    return dict(generalised_hopf_on(exact, errors["l2"]).coefficients) | {"errors": errors}
