"""Curves through a point of codimension two on a curve of special points of equilibria."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.linalg import newton
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.machine import elementary
from contin.special.table import curves_of_points
from contin.transitions.curve_through import seed_of
from contin.transitions.registry import born
from contin.transitions.zero_hopf_crossing import hopf_curves

SAME = 1e-6  # (of its typical size) values of kappa nearer than this belong to one curve
BESIDE = (1e-3, 1e-4, 1e-2)  # scaled distances from a DP at which the curve of folds is solved for


@born(LocusProblem, "", "the curve itself", parameters=2)
@born(LocusProblem, "CP BT ZH HH DP R1 R2 LPPD LPNS PDNS GPD CH NSNS", "the other curves through it", parameters=2)
def loci_through(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a point of a locus: those of other types first; its own only where there is no other."""
    own = problem.locus
    curve = problem.curve
    u, p = point.z[: problem.n], curve.full_parameters(point.z)
    parent = Parent.of(point)
    if point.vectors.get("plane"):
        return _across_plane(problem, point, parameters)
    types = curves_of_points(point.type, own)
    if point.vectors.get("forced"):  # no parameter unfolds the multiplier 1: no folds, but branch points
        types = tuple("BP" if type_ == "LP" else type_ for type_ in types)
    found: list[tuple[str, float]] = []
    for type_ in dict.fromkeys(types):
        for scalar in _scalars(point, type_):
            found.append((type_, scalar))
    tangential = curve.scalar(point.z) if own in ("HB", "NS") else 0.0
    same = SAME * (float(point.scale[-3]) if own in ("HB", "NS") and point.scale.size else 1.0)
    others = [f for f in found if f[0] != own or abs(f[1] - tangential) > same]
    chosen = others or [(own, tangential)]
    seeds = [
        seed_of(problem.system, type_, parameters, u, p, curve.sizes, problem.state_periods, scalar, parent)
        for type_, scalar in chosen
    ]
    if point.type == "DP":
        kind = str(problem.memory.get("kind", ""))
        return [_beside_branch_points(seed, point, kind) if seed.problem.locus == "LP" else seed for seed in seeds]
    return seeds


def _across_plane(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a zero-Hopf point on an invariant plane: the other Hopf curve, then the branch points.

    From the branch points both Hopf curves.
    """
    own, curve = problem.locus, problem.curve
    u, p, parent = point.z[: problem.n], curve.full_parameters(point.z), Parent.of(point)

    def seed(type_: str) -> Seed:
        scalar = _scalars(point, type_)[0]
        periods = problem.state_periods
        return seed_of(problem.system, type_, parameters, u, p, curve.sizes, periods, scalar, parent)

    same_order = tuple(parameters) == problem.parameters
    found = hopf_curves(seed("HB"), point, own == "HB" and same_order)
    return found if own == "BP" else [*found, seed("BP")]


def _beside_branch_points(seed: Seed, point: SpecialPoint, kind: str) -> Seed:
    """The curve of folds at a DP, where it crosses that of branch points (which are solutions of its system, too).

    A point of it has a state that left the branch: the equations are solved with the state that moves most held beside.
    """
    curve = seed.problem.curve  # type: ignore[attr-defined]
    widths = (float(point.scale[-1]), float(point.scale[-2]))
    scale = curve.scales(seed.z, widths)
    v = curve.vector(seed.z) / curve.sizes
    index = int(np.argmax(np.abs(v)))
    for step in BESIDE:
        guess = seed.z.copy()
        guess[: curve.n] += step * curve.sizes * v
        z = newton.with_one_fixed(curve.linearise, index, guess, float(guess[index]), scale)
        if z is not None:
            direction = (z - seed.z) / scale
            arms = (1,) if kind == "pitchfork" else (-1, 1)  # the other half of the folds is its mirror image
            return replace(seed, direction=direction / np.linalg.norm(direction), scale=scale, arms=arms)
    raise InputError(f"{point.branch}.{point.label}: the curve of folds that ends here could not be found")


def _scalars(point: SpecialPoint, type_: str) -> list[float]:
    """kappa of the curves of a type through the point: omega^2 of each critical pair (NS: cos theta), 0 at BT."""
    if type_ not in ("HB", "NS"):
        return [0.0]
    if point.type == "BT":
        return [0.0]
    if point.type in ("R1", "R2"):
        return [1.0 if point.type == "R1" else -1.0]
    pairs = [v for v in np.asarray(point.vectors["critical"]) if v.imag > 0.0]
    if type_ == "HB":
        return [elementary.square(float(v.imag)) for v in pairs]
    return [elementary.cos(elementary.angle(v)) for v in pairs]
