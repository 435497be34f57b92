"""Normal forms from centre manifolds of systems too large for dense methods."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.linear import Linear
from contin.loci.sparse.forced import is_forced
from contin.loci.sparse.large_manifold import LargeJet, LargeManifold, Solves, pair_of
from contin.loci.sparse.rounded_matrix import rounded
from contin.normalforms.hopf import conjugate, generalised_hopf_on
from contin.normalforms.hopf_hopf import hopf_hopf_on
from contin.normalforms.invariant_plane import zero_hopf_on_plane_of
from contin.normalforms.linear import EigenPair
from contin.normalforms.result import TRUST, NormalForm, NotThisTypeError
from contin.normalforms.zero_hopf import zero_hopf_on
from contin.problems.sparse.forms import SAMPLES, SPREAD, Derivatives
from contin.records import Fields

if TYPE_CHECKING:
    from contin.loci.sparse.on_large_curve import OnLargeCurve

DENSE: Final = 400  # unknowns up to which dense linear algebra takes a second at most

Deciding = Callable[[LargeManifold], dict[str, complex]]  # coefficients whose errors decide
FormOf = Callable[[LargeManifold, Mapping[str, float]], NormalForm]


def _of_bautin(manifold: LargeManifold) -> dict[str, complex]:
    return {"l2": manifold.g((3, 2), 0).real}


def _of_zero_hopf(manifold: LargeManifold) -> dict[str, complex]:
    g = manifold.g
    return {"G200": 2.0 * g((2, 0, 0), 0).real, "G011": g((0, 1, 1), 0).real, "G110": g((1, 1, 0), 1)}


def _of_hopf_hopf(manifold: LargeManifold) -> dict[str, complex]:
    return {"p11": manifold.g((2, 1, 0, 0), 0).real, "p22": manifold.g((0, 0, 2, 1), 2).real}


FORMS: Final[Mapping[str, tuple[Deciding, FormOf]]] = {
    "GH": (_of_bautin, lambda manifold, errors: generalised_hopf_on(manifold, errors["l2"])),
    "ZH": (_of_zero_hopf, zero_hopf_on),
    "HH": (_of_hopf_hopf, hopf_hopf_on),
}


@dataclass(frozen=True, eq=False)
class Place:
    """Derivatives and the Jacobian at a point of a curve, as they are or as well as they are known."""

    form: Derivatives
    linear: Linear

    def manifold(self, type_: str, known: Fields, active: tuple[int, ...] = ()) -> LargeManifold:
        """In the coordinates in which the forms are, from the eigenvectors that are `known` nearly."""
        return LargeManifold(LargeJet(self.form, self.linear, active), self._pairs(type_, known), Solves(self.linear))

    def _pairs(self, type_: str, known: Fields) -> list[EigenPair]:
        waves = sorted(zip(known["omegas"], known["pairs"], strict=True), key=lambda wave: -wave[0])
        needed = {"GH": 1, "ZH": 1, "HH": 2}[type_]
        if len(waves) < needed or (type_ == "ZH" and "null" not in known):
            raise NotThisTypeError("its eigenvalues on the imaginary axis are not found")
        found = [pair_of(self.linear, 0.0, known["null"])] if type_ == "ZH" else []
        for omega, q in waves[:needed]:
            pair = pair_of(self.linear, 1j * omega, q)
            found += [pair, conjugate(pair)]
        return found


def large_form(
    problem: OnLargeCurve, type_: str, z: Array, known: Fields, widths: Array, drift: Array
) -> Fields:  # fmt: skip
    """Coefficients of a GH, ZH or HH as the dense methods have them, and their errors: how far they scatter.

    drift : by how much z may be off.
    """
    if type_ not in FORMS:
        raise NotThisTypeError(f"beyond {DENSE} unknowns there are those of BT, CP, {', '.join(sorted(FORMS))}")
    curve = problem.curve
    here = Place(Derivatives(*curve.branch(z)), curve.linear_at(z))
    deciding, form_of = FORMS[type_]
    active: tuple[int, ...] = ()
    if type_ == "ZH" and problem.locus == "HB" and "null" in known:
        pair = pair_of(here.linear, 0.0, known["null"])
        if is_forced(problem, z, here.linear, pair, widths):
            active, form_of = (curve.first, curve.second), zero_hopf_on_plane_of
    exact = here.manifold(type_, known, active)
    found, errors = deciding(exact), dict[str, float]()
    for other in _as_well_as_known(problem, z, here, drift):
        beside = deciding(other.manifold(type_, known))
        for key, value in found.items():
            errors[key] = max(errors.get(key, 0.0), SPREAD * abs(beside[key] - value))
    form = form_of(exact, errors)
    return dict(form.coefficients) | {"errors": dict(form.errors)}


def _as_well_as_known(problem: OnLargeCurve, z: Array, here: Place, drift: Array) -> Iterator[Place]:
    """Places off by the error of the point and of rounding, with matrices of their own, which count beside resonances;
    and the place itself with other differences."""
    curve, generator = problem.curve, np.random.default_rng(9)
    branch, slopes = here.form.problem, here.form.problem.system.error_of_slopes
    sizes = np.abs(z)
    sizes[: curve.n] = np.maximum(sizes[: curve.n], branch.typical_sizes[:-1])
    sizes[-2:] = np.maximum(sizes[-2:], branch.system.lines.sizes[[curve.n + curve.second, curve.n + curve.first]])
    for sense in np.resize([1.0, -1.0], SAMPLES):
        off = z + sense * drift + TRUST * sizes * generator.uniform(-1.0, 1.0, z.size)
        matrix = rounded(curve.linear_at(off), slopes, generator)
        yield Place(Derivatives(*curve.branch(off), generator), matrix)
    for other in branch.system.with_other_differences():
        yield Place(Derivatives(branch, here.form.z, system=other), here.linear)
