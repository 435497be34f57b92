"""Points of one codimension more on a curve of special solutions, to full precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.linalg.newton import Rules, by_steps
from contin.loci.augmented.elimination import Augmented, Scalars
from contin.loci.tolerances import ILL_CONDITIONED, RESIDUAL_LIMIT

if TYPE_CHECKING:
    from contin.loci.augmented.curve_equations import CurveEquations, Near

NEWTON: Final = Rules(settled=1e-14, stalled=1e-7, far=1.0, budget=20)
SAMPLES: Final = 6
PERTURBATION: Final = 1e-10
SAFETY: Final = 4.0


@dataclass(frozen=True, eq=False)
class Solved:
    """z, what is left (largest correction, scaled) and the estimated error of the first parameter, scaled."""

    z: Array
    residual: float
    error: float


def solved(problem: CurveEquations, function: Scalars, near: Sample, scale: Array) -> Solved | None:
    """Newton on the equations of the curve and one more scalar."""
    around = problem.near(near.z, scale)
    if around is None:
        return None

    def step(z: Array) -> Array | None:
        here = _with(around, function, z, scale)
        return None if here is None or here.sign == 0.0 else here.solve(-here.residual)

    found = by_steps(step, near.z, scale, NEWTON)
    z = near.z if found is None else found.at
    here = _with(around, function, z, scale)
    if found is None or here is None or here.sign == 0.0:
        return None
    scatter = 0.0
    generator = np.random.default_rng(12345)
    for _ in range(SAMPLES):  # how rounding errors of the equations reach the solution
        shift = PERTURBATION * generator.uniform(-1.0, 1.0, z.size)
        there = _with(around, function, z + scale * shift, scale)
        if there is None:
            return None
        scatter = max(scatter, abs(float((shift - here.solve(there.residual))[-1])))
    return Solved(z, float(np.max(np.abs(here.residual), initial=0.0)), SAFETY * scatter + found.left)


def _with(near: Near, function: Scalars, z: Array, scale: Array) -> Augmented | None:
    """The equations with the further scalar in the place of the tangent's row."""
    inner = near.base.linearise(z, scale, near.rows)
    if inner is None:
        return None

    def scalars(at: Array) -> Array:
        return np.append(near.values(at), function(at))

    values = scalars(z)
    return Augmented(inner, scalars, values, z, scale, None) if np.all(np.isfinite(values)) else None


def verify(problem: CurveEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The point of this type near a sample."""
    function = problem.base.degeneracy(problem.type, type_, near)
    if isinstance(function, str):
        return unverified(type_, function)
    found = solved(problem, function, near, frame.scale)
    if found is None:
        return unverified(type_, "Newton on its defining system did not converge")
    if not (found.residual < RESIDUAL_LIMIT and found.error < ILL_CONDITIONED):
        return unverified(type_, f"its defining system has no regular solution nearby (residual {found.residual:.1e})")
    values = problem.base.stability(problem.type, found.z)[2]
    error = found.error * float(frame.scale[-1]) + float(np.finfo(float).eps) * abs(float(found.z[-1]))
    point = Verified(type_, found.z, found.residual, error, values, 0)
    return problem.base.described(problem.type, point, frame.scale)


def verify_compound(problem: CurveEquations, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
    """Each of the types whose test changes its sign."""
    found = []
    for type_ in problem.base.types(problem.type):
        index = problem.test_of(type_)
        if index is not None and opposite(a.tests[index], b.tests[index]):
            found.append(verify(problem, type_, a, frame))
    return found
