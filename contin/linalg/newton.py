"""Newton's method until rounding decides: one loop, whatever is corrected and however corrections are found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from contin.abi import Array
from contin.kernels.steering import STALLED
from contin.linalg.vectors import norm

T = TypeVar("T")


@dataclass(frozen=True)
class Rules:
    """When corrections end; their sizes are in the metric of whoever makes them.

    settled : a correction below this is the last one.  stalled : corrections below this that no longer fall to `ratio`
    of the one before are rounding, and are not made; beside singular points they fall like a geometric series, which is
    none.  far : one beyond this leads elsewhere, and so does one `growth`
    times as long as the one before, where that is not rounding.  budget : of corrections.
    """

    settled: float = 1e-15
    stalled: float = 1e-8
    far: float = np.inf
    budget: int = 12
    ratio: float = STALLED
    growth: float = np.inf


@dataclass(frozen=True, eq=False)
class Converged(Generic[T]):
    """Where corrections end.

    made : size of the last one that was made, inf where none was.  left : of the last one that is known: the same, or
    that of the rounding error that is left, or the sum of the series that the last ones begin.
    exhausted : the budget ended them, before they settled or stalled.
    """

    at: T
    made: float
    left: float
    exhausted: bool = False


def newton(correct: Callable[[T], tuple[float, T] | None], start: T, rules: Rules) -> Converged[T] | None:
    """Corrections from `start` until they settle or stall; None where they do not.

    correct : the size of the correction at a place and where it leads, or None where there is none.
    """
    at, before, falls = start, np.inf, 0.0
    for _ in range(rules.budget):
        found = correct(at)
        if found is None:
            return None
        size, there = found
        if not size < rules.far:  # NaN is no size
            return None
        if size >= rules.ratio * before and before < rules.stalled:
            return Converged(at, before, size)
        if not size < rules.growth * before:
            return None
        at, before, falls = there, size, size / before
        if size < rules.settled:
            return Converged(at, size, size)
    left = before * max(1.0, falls / (1.0 - falls)) if falls < 1.0 else before
    return Converged(at, before, left, exhausted=True) if before < rules.stalled else None


def by_steps(
    step: Callable[[Array], Array | None], start: Array, scale: Array | float, rules: Rules
) -> Converged[Array] | None:
    """`newton` in scaled unknowns: z + scale * step(z), a correction of the step's length."""

    def correct(z: Array) -> tuple[float, Array] | None:
        d = step(z)
        return None if d is None else (norm(d), z + scale * d)

    return newton(correct, start, rules)


def longest_part(
    look: Callable[[float], tuple[float, T] | None], size: float, enough: float, first: float = 1.0,
    shortest: float = 1e-4,
) -> tuple[float, T] | None:  # fmt: skip
    """The longest of the parts `first`, half of it, ... of a step that brings a solution nearer, and what is there.

    By natural monotonicity (Deuflhard, Newton Methods for Nonlinear Problems, 2004, 3.3): the next step by the same
    matrix, of which `look` tells the length, is at most 1 - part/4 times as long as this one (`size`), or less than
    `enough`. None where no part above `shortest` is, or has a value.
    """
    part = first
    while part > shortest:
        found = look(part)
        if found is not None and (found[0] <= (1.0 - 0.25 * part) * size or found[0] < enough):
            return part, found[1]
        part *= 0.5
    return None


def solution(matrix: Array, right: Array) -> Array | None:
    """matrix^-1 right; None where LAPACK finds the matrix singular: then Newton's method does not converge."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None


def with_one_fixed(
    linearise: Callable[[Array], tuple[Array, Array]], index: int, guess: Array, value: float, scale: Array
) -> Array | None:
    """F(z) = 0 (N - 1 equations, rows scaled like the unknowns) with z[index] = value; None where Newton fails."""
    start = guess.copy()
    start[index] = value
    free = np.arange(len(start)) != index % len(start)
    rows = scale[:-1]

    def step(z: Array) -> Array | None:
        f, jacobian = linearise(z)
        d = solution((jacobian * scale / rows[:, None])[:, free], -f / rows)
        if d is None:
            return None
        whole = np.zeros(len(start))
        whole[free] = d
        return whole

    found = by_steps(step, start, scale, Rules(far=1.0))
    return None if found is None else found.at
