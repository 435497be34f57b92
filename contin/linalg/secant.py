"""The zero of a smooth function of one variable by the secant method, until rounding decides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

import numpy as np

T = TypeVar("T")
EXACT: Final = 1e-13  # a step below this is the last one


@dataclass(frozen=True)
class SecantRules:
    """When steps end, in units of s.

    trial : the first step.  far : one beyond this leads elsewhere.  stalled : steps below this that no longer fall by
    half are rounding.  good : the last step of a zero is below this.  resolved : places nearer to each other tell no
    slope, the quotient of their values is one of roundings.  budget : of steps.
    """

    trial: float
    far: float
    stalled: float
    good: float
    resolved: float = 0.0
    budget: int = 30


@dataclass(frozen=True, eq=False)
class SecantZero(Generic[T]):
    """The place s, what was found there with its value, the slope of the values, and the length of the last step."""

    s: float
    at: T
    value: float
    slope: float
    step: float


def secant(look: Callable[[float, T | None], tuple[T, float] | None], rules: SecantRules) -> SecantZero[T] | None:
    """The zero near s = 0; None where there is none, or where nothing is found at a place.

    look : what is at a place s, from what is at a place near it (None: from the beginning), and its value.
    """
    first, second = look(0.0, None), look(rules.trial, None)
    if first is None or second is None:
        return None
    (s0, v0), (s1, at, v1) = (0.0, first[1]), (rules.trial, *second)
    if abs(v0) < abs(v1):
        s0, v0, s1, at, v1 = rules.trial, v1, 0.0, *first
    slope, last = 0.0, np.inf
    for _ in range(rules.budget):
        if v1 == v0:
            break
        if slope == 0.0 or abs(s1 - s0) > rules.resolved:
            slope = (v1 - v0) / (s1 - s0)
        step = -v1 / slope
        stalls = abs(step) >= 0.5 * last and last < rules.stalled
        if not np.isfinite(step) or abs(step) > rules.far or stalls:
            break
        found = look(s1 + step, at)
        if found is None:
            return None
        s0, v0 = s1, v1
        s1 += step
        at, v1 = found
        last = abs(step)
        if last < EXACT:
            break
    return SecantZero(s1, at, v1, slope, last) if last < rules.good else None
