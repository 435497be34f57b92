"""Derivatives along a line of an analytic function from its values on a circle in the complex plane.

The trapezoidal rule on a circle of radius r gives all Taylor coefficients at once (Fornberg, ACM TOMS 7 (1981) 512): an
error of about k! 1e-16 / r^k for the k-th derivative, beside what coefficients of order k + 16 and higher add. The
last coefficients tell of these: where they are not small beside the others (a pole is near), the circle is made
smaller. Where they are small and no smaller than those before them, they are rounding errors of the values (terms of
another size cancel in them), of which a smaller circle makes more. So are components that do not change along the line
but for rounding (constraints along directions that keep them).

Where an unknown is far smaller than others (zero, but for rounding), circles of its size may lose all digits: larger
ones are tried then (`tiny`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.machine import elementary
from contin.systems.functions import tiny

RADIUS: Final = 0.1  # relative to the size of the unknowns
POINTS: Final = 16
LAST: Final = range(12, 16)  # coefficients that tell whether the series converges on the circle
BEFORE: Final = range(8, 12)
CONVERGED: Final = 1e-12  # of the largest coefficient, times r^order: then those of order 16 and more are rounding
FALLEN: Final = 1e-2  # part of the last coefficients' share from which a smaller circle is better: rounding's stays
ROUNDED: Final = 1e-6  # of the largest: a series that has come to it by order 12 falls by .01 in the next four orders,
FLAT: Final = 0.1  # and has not fallen to this part of itself where rounding is all that is left
EPS: Final = float(np.finfo(float).eps)
LOST: Final = 16.0 * EPS  # of how much a component changes with its arguments' sizes: rounding of sums of some terms
SMALLER: Final = (1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3)
TINY: Final = float(np.finfo(float).tiny)


@cache
def nodes(whole: bool = False) -> tuple[tuple[complex, ...], Vector]:
    """The upper half of the unit circle's nodes w (the lower is its conjugate), and weight w^-k of each for each k.

    whole : of a function that is not real on the axis, all of them.
    """
    half = POINTS // 2
    upper = [elementary.exp(1j * np.pi * j / half) for j in range(POINTS if whole else half + 1)]
    weights = [(1.0 if j in (0, half) or whole else 2.0) / POINTS for j in range(len(upper))]
    turned = [[weight * w**-k for w, weight in zip(upper, weights, strict=True)] for k in range(POINTS)]
    return tuple(upper), np.array(turned)


def coefficients(values: Sequence[Vector], order: int | None = None, whole: bool = False) -> Vector:
    """Taylor coefficients times r^order, of one order or of all (POINTS, n), of a function that is real on the axis.

    values : at r times the upper nodes, or (`whole`) at all of them, of a function that is not real there.
    """
    _, turned = nodes(whole)
    rows = turned if order is None else turned[order]
    found = rows @ np.array(values, dtype=complex)
    return np.asarray(found if whole else found.real)


def derivative_on_circle(
    value: Callable[[complex], Vector], order: int, reach: float, size: int,
    taken: Callable[[float], None] | None = None, changes: Callable[[], Vector] | None = None, room: float = 1.0,
    whole: bool = False, unsure: np.random.Generator | None = None,
) -> Vector:  # fmt: skip
    """d^k/dt^k of value(t) at t = 0, (size,), real for real t if not `whole`; NaN where the circle is too small for
    numbers.

    reach : over which t the arguments change by their own sizes.  taken : told the radius from which some component is.
    changes : by how much components do where the arguments change by their sizes in a generic direction, (size,); asked
    where the largest circle does not do.  room : how many times larger ones may be (`tiny.room`).
    unsure : every number is off by as much as it may be by rounding then, for errors of what is made of it.
    """
    upper, _ = nodes(whole)
    best, missing = np.full(size, np.nan, complex if whole else float), np.ones(size, dtype=bool)
    tail, lost = np.full(size, np.inf), np.full(size, np.inf)
    for smaller in SMALLER:
        r = RADIUS * reach * smaller
        power = elementary.pow(r, order)
        if not power > TINY:
            break
        terms = coefficients([value(r * w) for w in upper], whole=whole)
        unit = math.factorial(order) / power
        found = terms[order] * unit
        last, before, largest, ratio = _sizes(terms)
        better = missing & ((ratio < FALLEN * tail) | ~np.isfinite(best))
        if taken is not None and better.any():
            taken(r)
        best, tail = np.where(better, found, best), np.where(better, ratio, tail)
        lost = np.where(better, EPS * largest * unit, lost)
        missing = missing & ~_converged(last, before, ratio)
        if missing.any() and changes is not None:
            missing = missing & ~(largest <= LOST * changes())
        if not missing.any():
            break

    def wider(times: float) -> tuple[Vector, Array, NDArray[np.bool_]]:
        r = RADIUS * reach * times
        terms = coefficients([value(r * w) for w in upper], whole=whole)
        unit = math.factorial(order) / elementary.pow(r, order)
        last, before, largest, ratio = _sizes(terms)
        return terms[order] * unit, EPS * largest * unit, _converged(last, before, ratio)

    ahead = lambda times: taken and taken(RADIUS * reach * times)  # noqa: E731
    best, lost = tiny.with_more_digits(best, lost, wider, room, ahead)
    return best if unsure is None else np.asarray(best + lost * unsure.uniform(-1.0, 1.0, size))


def _sizes(terms: Vector) -> tuple[Array, Array, Array, Array]:
    """Of the last coefficients, of those before them, of all, and what part of these the last are."""
    last, before, largest = (np.max(np.abs(part), axis=0) for part in (terms[LAST], terms[BEFORE], terms))
    ratio = np.where(largest > 0.0, last / np.where(largest > 0.0, largest, 1.0), 0.0)
    ratio[~np.isfinite(largest)] = np.inf  # a pole on the circle, or numbers too large
    return last, before, largest, ratio


def _converged(last: Array, before: Array, ratio: Array) -> NDArray[np.bool_]:
    return (ratio <= CONVERGED) | ((ratio <= ROUNDED) & (last >= FLAT * before))
