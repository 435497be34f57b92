"""Which points are one: angles count modulo their periods, auxiliary vectors (with a free sign) not at all."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem, in_two_parameters

SAME_POINT: Final = 1e-8  # two verified points of one type closer than this (scaled) are one
SAME_FREQUENCY: Final = 1e-6  # relative
SURE: Final = 10.0  # times the estimated errors of two parameters: they are different
ROUNDING: Final = 1e-13  # ... beyond this, scaled


def same_point(problem: Problem, a: Verified, b: Verified, scale: Array) -> bool:
    """One type at one place and, for oscillations, one frequency; for extrema, of one column: two may turn at once."""
    if a.type != b.type or a.normal_form.get("of") != b.normal_form.get("of"):
        return False
    if problem.adaptive:
        return problem.same_point(a, b, scale)
    u, v = a.vectors.get("omega", 0.0), b.vectors.get("omega", 0.0)
    distance = float(np.linalg.norm(offset(problem, a.z, b.z, scale)))
    if a.touches and b.touches:  # located by degenerate equations: no better than their errors
        return distance <= SAME_POINT + SURE * (a.error + b.error) / float(scale[-1])
    reach = float(a.vectors.get("reach", 0.0)) + float(b.vectors.get("reach", 0.0))  # of errors along the curve
    near = distance < max(SAME_POINT, 2.0 * (a.error + b.error) / float(scale[-1]), 2.0 * reach)
    if not in_two_parameters(problem):  # two events may be nearer than that, where both are known better
        near &= abs(float(a.z[-1] - b.z[-1])) <= SURE * (a.error + b.error) + ROUNDING * float(scale[-1])
    return near and abs(u - v) <= SAME_FREQUENCY * (abs(u) + abs(v))


def slack(a: Verified, b: Verified, scale: Array) -> float:
    """By how much the parameters of two points may differ that were found on different meshes, and are one."""
    return 3.0 * (a.error + b.error) + 1e-9 * float(scale[-1])


def offset(problem: Problem, a: Array, b: Array, scale: Array) -> Array:
    """a - b in scaled unknowns, of those that tell points apart; 0 for the others."""
    return seen(problem, wrapped(problem, a - b) / scale)


def seen(problem: Problem, difference: Array) -> Array:
    """A difference without the unknowns that do not tell points apart."""
    return np.where(problem.identifying, difference, 0.0) if in_two_parameters(problem) else difference


def wrapped(problem: Problem, difference: Array) -> Array:
    """A difference with its angles between minus and plus half a period."""
    periods = problem.angle_periods
    angles = np.flatnonzero(periods)
    if angles.size:
        difference = difference.copy()
        p = periods[angles]
        difference[angles] -= p * np.round(difference[angles] / p)
    return difference
