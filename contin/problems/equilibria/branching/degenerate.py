"""Branch points whose leading terms do not tell all branches: which these are, and the fan of half-branches there."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.outcome import Verified
from contin.machine import elementary
from contin.problems.equilibria.branching.halves import Fan, fan
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.branching.reduced import ReducedEquations
from contin.problems.equilibria.rounding_of_tests import branch_point_is_lost
from contin.problems.equilibria.scaled import ScaledSystem

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

KINDS = ("tangency", "degenerate")  # of simple branch points
ACCURATE = 2  # order of contact up to which Newton's method places the point well
UNCLEAR = 3.0  # times the error of a simple zero, where the order of a degenerate one is not known
NEAREST, FARTHEST, GROWTH, CLEAR = 1e-9, 0.1, 2.0, 4  # scaled distances at which a degenerate point may still be hidden
ANGLES, SECTIONS, SECTION = 24, 30, 0.6180339887498949  # of a half circle; golden sections of the best part
ALONG = 0.99  # cosine of a curve's tangent and the branch's own from which they may be one


def is_degenerate(point: Verified | SpecialPoint) -> bool:
    """True where the leading terms of the reduced equations have solutions that are not simple."""
    form = point.normal_form
    flat = form.get("continua") and form.get("scaling") != "cubic"  # a symmetry's continuum is one of cubic terms
    return bool(form.get("kind") in KINDS or form.get("repeated") or flat)


def fan_at(problem: AlgebraicEquations, z: Array, scale: Array, corank: int) -> Fan | None:
    """The half-branches at z, in the metric `scale`; None where no sphere around z tells them apart."""
    y = z / scale
    return fan(ReducedEquations.at(ScaledSystem(problem, scale).rated(y), y, corank))


def other_curves(found: Fan, own: Array | None, tangent: Array) -> list[Outset]:
    """How the curves other than the branch's own set out.

    own : a point of the branch, or None; tangent : the branch's tangent at the point, zero where there is none.
    """
    mine = None if own is None else found.curve_of(own)
    if mine is not None:
        curves = [curve for curve in found.curves if mine[0] not in curve]
    else:
        straight = [c for c in found.curves if abs(float(c[0].direction @ tangent)) > ALONG]
        curves = [c for c in found.curves if len(straight) != 1 or c is not straight[0]]
        curves.sort(key=lambda c: abs(float(c[0].direction @ tangent)))
    return [found.outset(curve) for curve in curves]


def described(problem: AlgebraicEquations, point: Verified, scale: Array) -> Verified:
    """The point with the number of its branches and, of two that touch, the order of their contact."""
    corank = int(point.vectors.get("kernel", 1))
    found = fan_at(problem, point.z, scale, corank)
    if found is None:
        text = "BP: its leading terms do not tell the branches, and no sphere around it does: some may not be followed"
        return _with(point, text)
    form: dict[str, object] = {**point.normal_form, "branches": len(found.curves)}
    if corank > 1:
        return _with(point, "", form, touches=False)
    contact = found.contact()
    if contact is None:
        count = len(found.curves)
        halves = sum(map(len, found.curves))
        if form.get("kind") != "tangency" or (count, halves) != (2, 4):
            form["kind"] = "degenerate"
        text = f"BP: degenerate, {count} branch{'es' * (count != 1)} of {halves} halves meet there"
        error, hidden = UNCLEAR * point.error, _lost_along(problem, point.z, scale)
        if hidden > error:
            error, text = hidden, f"{text}, or cross several times within the stated error"
        return replace(_with(point, text, form, touches=count > 0), error=error)
    order = f"contact of order {contact.order}"
    text = f"BP: two branches touch with {order}, or cross several times within the stated error"
    touching = _with(point, text, {**form, "contact": contact.order}, touches=True)
    touching = replace(touching, error=max(point.error, _lost_along(problem, point.z, scale)))
    if contact.order <= ACCURATE:
        return touching
    # located where a function of high order is lost in its rounding errors: how far off is what the gaps say
    return replace(touching, error=max(touching.error, 2.0 * abs(float(contact.off[-1])) * float(scale[-1])))


def _lost_along(problem: AlgebraicEquations, z: Array, scale: Array) -> float:
    """How far in the parameter, along whatever passes there, rounding hides that the point is passed.

    Simple crossings beside each other, in skewed coordinates, look like one degenerate point between them. Along a
    branch through both, [F_u F_p] is singular to rounding; on circles about the point in its kernel it is looked for.
    """
    farthest, distance = 0.0, NEAREST
    local = _local(problem, z, scale)
    kernel = np.linalg.svd(_scaled(local, z))[2][-2:]
    clear = 0  # distances in turn: half way to a crossing more is seen than next to it
    while distance < FARTHEST and clear < CLEAR:
        found = _most_singular(local, z, distance * kernel)
        clear += 1
        if found is not None and branch_point_is_lost(_scaled(local, found)):
            farthest, clear = max(farthest, GROWTH * abs(float(found[-1] - z[-1]))), 0
        distance *= GROWTH
    return farthest


def _most_singular(local: ScaledSystem, z: Array, kernel: Array) -> Array | None:
    """The place on an ellipse about z, with the half-axes `kernel` (2, n + 1), where [F_u F_p] is nearest singular."""

    def at(angle: float) -> Array:
        return np.asarray(z + local.scale * (elementary.cos(angle) * kernel[0] + elementary.sin(angle) * kernel[1]))

    def size(angle: float) -> float:
        matrix = _scaled(local, at(angle))
        return float(np.linalg.svd(matrix, compute_uv=False)[-1]) if np.isfinite(matrix).all() else np.inf

    step = np.pi / ANGLES
    sizes = [size(k * step) for k in range(ANGLES)]
    best = int(np.argmin(sizes))
    if not np.isfinite(sizes[best]):
        return None
    low, high = (best - 1) * step, (best + 1) * step
    for _ in range(SECTIONS):
        left, right = high - SECTION * (high - low), low + SECTION * (high - low)
        low, high = (low, right) if size(left) < size(right) else (left, high)
    return at(0.5 * (low + high))


def _local(problem: AlgebraicEquations, z: Array, scale: Array) -> ScaledSystem:
    """Equations without time by the sizes of their rows, others in the units of their states."""
    local = ScaledSystem(problem, scale)
    return local.rated(z / scale) if problem.is_timeless else local


def _scaled(local: ScaledSystem, z: Array) -> Array:
    return local.linearise(z / local.scale)[1]


def _with(point: Verified, remark: str, form: dict[str, object] | None = None, touches: bool = False) -> Verified:
    return replace(point, remark=remark, normal_form=form or point.normal_form, touches=touches)


def scaled_own(point: Verified | SpecialPoint, scale: Array) -> Array | None:
    """The point of the branch beside it by which the branch is known, in the metric `scale`."""
    own = point.vectors.get("beside")
    return None if own is None else np.asarray(own / scale)
