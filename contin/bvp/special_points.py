"""Folds and branch points of boundary-value problems: what a change means, location to full precision, tangents.

A fold is the zero of dp/ds on the curve, a branch point that of the gradient of the reduced equation; both on the mesh
of the branch. The stated error holds what the same point moves to on a mesh of twice as many intervals.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from contin.abi import Array
from contin.bvp import normal_forms
from contin.bvp.changing_formulas import moving_jump
from contin.bvp.condensed import Condensed, linearise, residual_at
from contin.bvp.continuum import NONE, free_function
from contin.bvp.defects import finer as finer_mesh
from contin.bvp.imperfection import imperfection
from contin.bvp.kernel_at_branch_point import SmallestValues, kernel_dimension, nearly_null, null_vector, smallest
from contin.bvp.on_mesh import OnMesh
from contin.bvp.several_modes import ALONG, form_of, reduced_to_kernel
from contin.continuation.outcome import Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.errors import InputError
from contin.linalg.vectors import norm
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.sparse.reduced_equation import Reduced, border_rows
from contin.problems.sparse.zero_on_curve import zero_on_curve
from contin.records import Fields

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

RESIDUAL_LIMIT = 1e-7
REGULAR = 1e8  # a tangent from the bordered matrix longer than this: the matrix without it is singular
PERTURBATION = 1e-8
ORDER = 1.25  # the finer mesh leaves an error of its own, 2^-2m of this one
WITHIN = 3.0  # errors of a coefficient within which it is zero
SEVERAL = "BP: two modes or more vanish at once; several branches cross there, of which one is switched to"
NOT_ALL = "BP: two modes or more vanish at once; the leading terms do not tell all branches that cross there"
NO_VALUES = np.zeros(0, complex)
ROUNDING = 64.0 * float(np.finfo(float).eps)  # of a sum over the nodes


def explain(a: Sample, b: Sample) -> tuple[str, ...] | None:
    """The determinant changes sign at branch points; dp/ds at folds, and at a pitchfork seen from its side branch."""
    fold, determinant = (bool(x) for x in opposite(a.tests[:2], b.tests[:2]))
    if determinant:
        return ("BP",)
    return ("LP",) if fold else ()


def verify(problem: BoundaryEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The point of this type near a sample, to full precision."""
    if moving_jump(problem, problem.profile(near.z), problem.sizes(near.z, frame.scale)) is not None:
        return unverified(type_, "the equations jump at a place that moves along the branch")
    mesh = OnMesh(problem, problem.profile(near.z).h)
    here = _in_unknowns(mesh, near)
    local = Frame(mesh.unknowns(frame.scale))
    found = _fold(problem, near, frame) if type_ == "LP" else _branch_point(mesh, here, local)
    if isinstance(found, Rejected):
        return found
    x, scatter = found.x, found.scatter()
    if not np.isfinite(scatter):
        return unverified(type_, "its place is not determined to any accuracy")
    other = _on_finer_mesh(problem, type_, near, frame, mesh, x)
    if other is None:
        return unverified(type_, "it is not there on a mesh of twice as many intervals")
    sizes = problem.sizes(near.z, frame.scale)
    finer = other.mesh
    apart = imperfection((mesh, x, found.left), (finer, other.x, other.left), sizes)
    if apart > 0.0:
        return unverified(type_, f"two branches pass each other there at a distance (equations met to {apart:.1e})")
    finer_sizes = finer.unknowns(make_scale(finer.h, problem.points, sizes, 1.0, float(frame.scale[-1])))[:-1]
    moved = abs(float(other.x[-1] - x[-1]))
    error = scatter + ORDER * moved + ROUNDING * abs(float(x[-1]))
    if type_ == "LP":
        form = normal_forms.fold(mesh, x, found.direction, local.scale[:-1])
        form |= normal_forms.moved_by_mesh(form, normal_forms.fold(finer, other.x, other.direction, finer_sizes))
        return Verified(type_, mesh.full(x), found.residual, error, NO_VALUES, 0, form, {})
    small = smallest(mesh, x)
    fine = normal_forms.branch_point(finer, other.x, other.direction, finer_sizes)
    form = form_of_branch_point(mesh, x, small, scatter + moved, local.scale, fine)
    crowded = nearly_null(mesh, x, small).shape[1] > 1
    known: Fields = {"kernel": 1, "free": free_function(mesh, x, small, local.scale[:-1])}
    jet = None
    if crowded and known["free"] == NONE:
        jet = reduced_to_kernel(mesh, x, here.tangent, local.scale, small, error)
    remark = SEVERAL if int(form.get("kernel", 1)) > 1 else ""
    if jet is not None:
        form, error, x = form_of(jet), error + abs(float(jet.z[-1] - x[-1])), jet.z
        remark = NOT_ALL if "repeated" in form or "continua" in form else ""
        crowded = not _known(form)  # all that nearly vanishes there vanishes together: no more is to be found
    return Verified(
        type_, mesh.full(x), found.residual, error, NO_VALUES, 0, form, known, crowded=crowded, remark=remark
    )


def verify_compound(problem: BoundaryEquations, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
    """Several changes at one place: the branch points there, else a fold.

    Where two modes vanish at once, no test changes its sign.
    """
    types = [t for t, k in (("BP", 1), ("LP", 0)) if opposite(a.tests[k], b.tests[k])]
    if not types:
        found = _together(problem, a, frame)
        return [replace(one, touches=True) if isinstance(one, Verified) else one for one in found]
    return _together(problem, a, frame) if types[0] == "BP" else [verify(problem, "LP", a, frame)]


def _together(problem: BoundaryEquations, near: Sample, frame: Frame) -> Sequence[Outcome]:
    """The branch points next to a sample, one for each small singular value, and a word where fewer are found."""
    mesh = OnMesh(problem, problem.profile(near.z).h)
    here, local = _in_unknowns(mesh, near), Frame(mesh.unknowns(frame.scale))
    if mesh.at(here.z) is None:
        return [verify(problem, "BP", near, frame)]
    directions = nearly_null(mesh, here.z, smallest(mesh, here.z))
    found: list[Outcome] = []
    seen: list[Array] = []
    for q in directions.T:
        first = _branch_point(mesh, here, local, q)
        if isinstance(first, Rejected) or any(_has_all(o, first.x, directions.shape[1], mesh, local) for o in found):
            continue
        if any(norm((first.x - x) / local.scale) <= ROUNDING for x in seen):
            continue
        seen.append(first.x)
        one = verify(problem, "BP", replace(near, z=mesh.full(first.x)), frame)
        if not isinstance(one, Verified):
            continue
        same = [o for o in found if _is_one(one, o, mesh, local)]
        if not same or all(_told(one) > _told(o) for o in same):  # one mode alone: of a place that is a little off
            found = [o for o in found if o not in same] + [one]
    if not found:
        return [verify(problem, "BP", near, frame)]
    kernel = max(_kernel(o) for o in found)
    if len(found) < directions.shape[1] and kernel == 1:
        found.append(unverified("BP", "others lie so close to it that they are not told apart"))
    return found


def _kernel(found: Outcome) -> int:
    return int(found.normal_form.get("kernel", 1)) if isinstance(found, Verified) else 1


def _told(found: Outcome) -> tuple[int, bool]:
    """How much is known of a place: the dimension of its kernel, and whether all branches through it are.

    On a mesh each mode vanishes at a place of its own, as far off as its error: the largest sees the others.
    """
    return _kernel(found), isinstance(found, Verified) and _known(found.normal_form)


def _known(form: Mapping[str, object]) -> bool:
    return form.get("kind") != "degenerate"


def _has_all(found: Outcome, x: Array, modes: int, mesh: OnMesh, frame: Frame) -> bool:
    """Whether all modes vanish together at a place, with all branches known, and x is what one finds of it alone."""
    if not isinstance(found, Verified) or _told(found) < (modes, True):
        return False
    return _is_near(x - mesh.unknowns(found.z), found.error, frame)


def _is_one(a: Verified, b: Outcome, mesh: OnMesh, frame: Frame) -> bool:
    assert isinstance(b, Verified)
    return _is_near(mesh.unknowns(a.z) - mesh.unknowns(b.z), a.error + b.error, frame)


def _is_near(apart: Array, error: float, frame: Frame) -> bool:
    off, errors = apart / frame.scale, 3.0 * error / float(frame.scale[-1]) + ROUNDING
    return norm(off) <= errors or (abs(float(off[-1])) <= errors and norm(off) <= ALONG)


@dataclass(frozen=True, eq=False)
class Found:
    """A point x on a mesh, its residual, the direction in which the solution moves there, and how far x scatters."""

    x: Array
    residual: float
    direction: Array
    scatter: Callable[[], float]
    mesh: OnMesh  # with what it knows of its last places
    left: Array | None = None  # of a branch point: the left null vector of F_u


def _in_unknowns(mesh: OnMesh, sample: Sample) -> Sample:
    t = mesh.unknowns(sample.tangent)
    return Sample(mesh.unknowns(sample.z), t / norm(t), sample.tests, 0, NO_VALUES)


@dataclass(frozen=True, eq=False)
class Chain:
    """The equations as the march has them, by elimination along the chain of intervals: twenty times as fast as
    sparse factors where there are many functions."""

    problem: BoundaryEquations

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Condensed | None:
        return linearise(self.problem, z, tangent, scale)

    def residual(self, z: Array) -> Array:
        here = residual_at(self.problem, z)
        return np.full(z.size - 1, np.nan) if here is None else here


def _fold(problem: BoundaryEquations, near: Sample, frame: Frame) -> Found | Rejected:
    found = zero_on_curve(Chain(problem), near, frame, lambda at: float(at.tangent[-1]))
    if found is None:
        return unverified("LP", "the parameter does not turn at one point of the curve")
    at, error = found.at, found.error
    residual = max(at.residual, abs(found.left) / max(1.0, abs(found.slope)))  # sharp bends enlarge the rounding of s
    if not residual < RESIDUAL_LIMIT:
        return unverified("LP", f"its defining system has no solution nearby (residual {residual:.1e})")
    mesh = OnMesh(problem, problem.profile(at.z).h)
    moving = mesh.unknowns(at.tangent) * mesh.unknowns(frame.scale)
    return Found(mesh.unknowns(at.z), residual, moving[:-1], lambda: error, mesh)


def reduction(
    mesh: OnMesh, x: Array, tangent: Array, scale: Array, q: Array | None = None
) -> tuple[Reduced, Array]:  # fmt: skip
    """The reduced equation at x, bordered by q (the null vector of F_u; returned too) and the direction across it."""
    q = null_vector(mesh, x) if q is None else q
    null = np.append(q, 0.0) / scale
    null /= norm(null)
    linear = mesh.linear(x)
    assert linear is not None
    left = linear.factor.solve_transposed(q)
    return Reduced(mesh, border_rows(null[:, None], tangent, scale), left / norm(left), scale), q


def _branch_point(mesh: OnMesh, near: Sample, frame: Frame, q: Array | None = None) -> Found | Rejected:
    reduced, q = reduction(mesh, near.z, near.tangent, frame.scale, q)
    found = reduced.branch_point(near.z)
    if found is None:
        return unverified("BP", "Newton on the reduced equation did not converge")
    x, sizes = found.z, frame.scale[:-1]  # so that a residual does not depend on the functions' units
    left = max(abs(found.mu), float(np.max(np.abs(found.gradient)))) * float(np.max(np.abs(reduced.column / sizes)))
    residual = max(float(np.max(np.abs(mesh.residual(x) / sizes))), left)
    if not residual < RESIDUAL_LIMIT:
        return unverified("BP", f"its defining system has no solution nearby (residual {residual:.1e})")

    def scatter() -> float:
        shift = np.random.default_rng(3).uniform(-1.0, 1.0, x.size) / np.sqrt(x.size)
        again = reduced.branch_point(x + PERTURBATION * frame.scale * shift, found.hessian)
        return np.inf if again is None else 4.0 * abs(float(again.z[-1] - x[-1]))

    return Found(x, residual, q, scatter, mesh, reduced.column)


def form_of_branch_point(
    mesh: OnMesh, x: Array, small: SmallestValues, error: float, scale: Array, finer: Fields | None = None
) -> Fields:  # fmt: skip
    """The normal form of a branch point, `degenerate` where the error of the place may change the sign that decides.

    finer : that on a finer mesh, where errors are to hold the mesh's own.
    Without a stability to take over there is no other word for its criticality. Where the kernel has more than one
    dimension there are no coefficients of one direction.
    """
    kernel, q = kernel_dimension(small), small[1][:, 0]
    if kernel > 1:
        return {"kind": "degenerate", "kernel": kernel}
    sizes = scale[:-1]
    form = normal_forms.branch_point(mesh, x, q, sizes)
    off = max(error / float(scale[-1]), ROUNDING)
    moved = x + off * np.append(q / norm(q / sizes), scale[-1])  # states are known as well as the parameter
    other = normal_forms.branch_point(mesh, moved, q, sizes)
    numbers = [name for name, value in form.items() if isinstance(value, float) and name in other]
    errors = {name: abs(float(form[name]) - float(other[name])) for name in numbers}
    by_mesh: Fields = {} if finer is None else normal_forms.moved_by_mesh(form, finer)
    errors |= {name: errors[name] + off for name, off in by_mesh.get("errors", {}).items() if name in errors}
    found = {name: value for name, value in form.items() if name != "criticality"} | {"errors": errors}
    if form["kind"] == "transcritical" and abs(float(form["b20"])) <= WITHIN * errors["b20"]:
        found["kind"] = "pitchfork"
    if found["kind"] == "pitchfork" and abs(float(form["b30"])) <= WITHIN * errors["b30"]:
        found["criticality"] = "degenerate"
    return found


def _on_finer_mesh(
    problem: BoundaryEquations, type_: str, near: Sample, frame: Frame, mesh: OnMesh, x: Array
) -> Found | None:
    """The same point where every interval is halved."""
    if type_ == "LP":
        there = problem.refined(replace(near, z=mesh.full(x)), frame)
        fold = None if there is None else _fold(cast("BoundaryEquations", there[0]), *there[1:])
        return None if fold is None or isinstance(fold, Rejected) else fold
    sizes = problem.sizes(near.z, frame.scale)
    h = finer_mesh(problem, mesh.profile(x), sizes)
    finer = OnMesh(problem, h)
    old = mesh.profile(x).on_mesh(h)
    scale = finer.unknowns(make_scale(h, problem.points, sizes, 1.0, float(frame.scale[-1])))
    raw = mesh.unknowns(near.tangent) * mesh.unknowns(frame.scale)
    t = np.append(mesh.profile(raw).on_mesh(h).u.ravel(), raw[-1]) / scale
    start = Sample(np.append(old.u.ravel(), x[-1]), t / norm(t), near.tests, 0, NO_VALUES)
    found = _branch_point(finer, start, Frame(scale))
    return None if isinstance(found, Rejected) else found


def tangents(problem: BoundaryEquations, z: Array, scale: Array) -> list[Array]:
    """Unit tangents (scaled, like z) of the branches through z: one, or at a branch point two."""
    mesh = OnMesh(problem, problem.profile(z).h)
    x, d = mesh.unknowns(z), mesh.unknowns(scale)
    row = np.random.default_rng(5).normal(size=x.size)
    here = mesh.linearisation(x, row / norm(row), d)
    if here is None:
        raise InputError(problem.describe_failure(z))
    t = here.solve(np.append(np.zeros(x.size - 1), 1.0))
    size = norm(t)
    if np.isfinite(size) and size < REGULAR:
        return [embedded(mesh, t)]
    reduced, _ = reduction(mesh, x, np.append(np.zeros(mesh.n), 1.0), d)
    return [embedded(mesh, direction / d) for direction, _ in reduced.crossing(x)] or [embedded(mesh, t)]


def embedded(mesh: OnMesh, x: Array) -> Array:
    """A direction in x as one in z (the mesh does not move), of unit length."""
    out = np.zeros(mesh.n + len(mesh.h) + 2)
    out[: mesh.n], out[-1] = x[:-1], x[-1]
    return out / norm(out)
