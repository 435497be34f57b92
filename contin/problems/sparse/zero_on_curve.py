"""The zero of a smooth function of the arclength of a curve, to rounding, by the secant method.

Its error is the scatter of results from points that are perturbed by 1e-9.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.outcome import Failure
from contin.continuation.sample import Frame, Sample
from contin.linalg.secant import SecantRules, SecantZero, secant
from contin.linalg.vectors import dot, norm
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.problems.sparse.equations import CorrectedEquations

SECANT: Final = SecantRules(trial=1e-4, far=0.3, stalled=1e-6, good=1e-4, resolved=1e-9, budget=10)  # scaled arclength
PERTURBATION: Final = 1e-9
NOISE: Final = 1e-7  # of a correction that rounding may be, on long connecting orbits
ACCURACY: Final = 1e-13  # of the last Newton correction (or where rounding stops it)
SAMPLES: Final = 2
EPSILON: Final = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class At:
    """The point of the curve at a length from a base: z, its unit tangent (scaled), the scaled residual."""

    z: Array
    tangent: Array
    residual: float


def point_at(problem: CorrectedEquations, base: Sample, length: float, guess: Array, frame: Frame) -> At | None:
    """Newton on the plane <base.tangent, (z - base.z)/scale> = length to the attainable accuracy."""
    y = (guess - base.z) / frame.scale

    def corrected(tolerance: float) -> corrector.Corrected | Failure:
        if isinstance(problem, corrector.Sparing):
            return corrector.correct(
                problem, base.z, base.tangent, length, y, frame.scale, tolerance, problem.again,
                decisions=problem.decisions,
            )  # fmt: skip
        return corrector.correct(problem, base.z, base.tangent, length, y, frame.scale, tolerance)

    found = corrected(ACCURACY)
    if found is Failure.NO_CONTRACTION:  # from a guess that is as good as rounding allows, every correction is noise
        found = corrected(NOISE)
    if isinstance(found, Failure):
        return None
    last = found.last
    if found.off > ACCURACY:  # its tangent is off by as much, and what is measured with it
        there = problem.linearisation(found.z, base.tangent, frame.scale)
        if there is None:
            return None
        last = there
    t = last.solve(np.append(np.zeros(len(found.z) - 1), 1.0))
    residual = problem.residual(found.z) / frame.scale[:-1]
    return At(found.z, t / norm(t), float(np.max(np.abs(residual))))


Measure = Callable[[At], float]


@dataclass(frozen=True, eq=False)
class Zero:
    """Where a measure vanishes on the curve: the point, the value left, the estimated error of the parameter, and the
    slopes of the measure by the arclength (scaled) and by the parameter, infinite where that does not change."""

    at: At
    left: float
    error: float
    slope: float
    by_parameter: float


def zero_on_curve(problem: CorrectedEquations, base: Sample, frame: Frame, measure: Measure) -> Zero | None:
    """The zero of `measure` near base."""

    def evaluate(s: float, near: At | None) -> tuple[At, float] | None:
        start = At(base.z, base.tangent, 0.0) if near is None else near
        passed = dot(base.tangent, (start.z - base.z) / frame.scale)
        guess = start.z + (s - passed) / dot(base.tangent, start.tangent) * frame.scale * start.tangent
        at = point_at(problem, base, s, guess, frame)
        return None if at is None else (at, measure(at))

    found = secant(evaluate, SECANT)
    if found is None:
        return None
    at, slope = found.at, found.slope
    rate = float(at.tangent[-1]) * float(frame.scale[-1])
    by_parameter = slope / rate if rate != 0.0 else np.inf
    error = _scatter(problem, base, frame, measure, found)
    return Zero(at, found.value, error, slope, by_parameter)


def _scatter(
    problem: CorrectedEquations, base: Sample, frame: Frame, measure: Measure, found: SecantZero[At]
) -> float:
    """Error of the parameter from the same evaluation at perturbed points."""
    at, slope = found.at, found.slope
    generator = np.random.default_rng(2)
    worst = 0.0
    rate = float(at.tangent[-1])
    for _ in range(SAMPLES):
        shift = PERTURBATION * generator.uniform(-1.0, 1.0)
        other = point_at(problem, base, found.s + shift, at.z, frame)
        if other is None:
            return np.inf
        moved = (other.z[-1] - at.z[-1]) / frame.scale[-1] - shift * 0.5 * (rate + float(other.tangent[-1]))
        off = (measure(other) - found.value) / slope - shift if slope != 0.0 else 0.0
        bend = abs(float(other.tangent[-1]) - rate) / abs(shift)
        worst = max(worst, abs(moved) + abs(off * rate) + 0.5 * bend * elementary.square(off))
    return 4.0 * worst * float(frame.scale[-1]) + EPSILON * abs(float(at.z[-1]))
