"""Derivatives along a line by central differences, whose steps are as narrow as the function asks for.

A stencil of order 6 to 8 and the one within it, of two orders less, use the same values: how much they differ tells
whether the steps are short beside the lengths over which the function bends. Each component takes the widest steps for
which that holds; where none are (rounding, of terms that cancel inside the function), the widest of all, since narrower
ones lose more. First derivatives at a corner are those of the steps for which the two differ least.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.systems.functions import tiny

STEPS: Final = {1: 2e-3, 2: 1e-2, 3: 2e-2, 4: 4e-2, 5: 6e-2}  # relative: rounding and truncation balance
HALF_WIDTHS: Final = {1: 3, 2: 4, 3: 5, 4: 5, 5: 6}
NARROWER: Final = (1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3)
FIRST: Final = (1.0, 0.1, 1e-2, 1e-3, 1e-4)  # of first derivatives, which lose less to rounding
RESOLVED: Final = 1e-7  # relative difference of the two stencils from which truncation of the wider one is some 1e-9
NEARLY: Final = 1e-5  # ... that no chance brings about: narrower steps are better, though rounding is in sight
RESOLVED_SLOPE: Final = 1e-4  # ... of first derivatives, whose inner stencil has order 2 and whose outer one has 6
ROUNDING: Final = {1: 1e-14, 2: 2e-15, 3: 2e-15, 4: 2e-15, 5: 2e-15}  # of a value, relative, which is itself a sum


@cache
def stencil(order: int, half: int | None = None) -> tuple[tuple[int, float], ...]:
    """Offsets and weights of the central difference for the derivative of this order on unit spacing."""
    half = HALF_WIDTHS[order] if half is None else half
    offsets, found = range(-half, half + 1), []
    for here in offsets:  # k! times the coefficient of x^k in Lagrange's polynomial, exactly: weights add up to 0
        polynomial = [Fraction(math.factorial(order))]
        for o in offsets:
            if o != here:
                pairs = zip([Fraction(0), *polynomial], [*polynomial, Fraction(0)], strict=True)
                polynomial = [(below - o * same) / (here - o) for below, same in pairs]
        found.append((here, float(polynomial[order])))
    return tuple((o, weight) for o, weight in found if weight)


def differentiated(
    value: Callable[[float], Array], order: int, reach: float, levels: tuple[float, ...] = (),
    grain: Array | float = 0.0, room: float = 1.0, unsure: np.random.Generator | None = None,
) -> Array:  # fmt: skip
    """d^k/dt^k of value(t) at t = 0, an array of any shape.

    reach : over which t the arguments change by their own sizes.  levels : how many times narrower steps are tried.
    grain : what values are off by at random (`grain.grain`): between steps of a rounded function two stencils agree by
    chance, with nothing to see.  room : how many times wider steps may be (`tiny.room`).
    unsure : every number is off by as much as it may be then, for errors of what is made of it.
    """
    some = np.inf if order == 1 else NEARLY
    best: Array | None = None
    for narrower in levels or (FIRST if order == 1 else NARROWER):
        found, apart, rounding, settled = _compared(value, order, reach * narrower, grain)
        size = np.abs(found)
        here = apart if order == 1 else np.where(size > 0.0, apart / np.where(size > 0.0, size, 1.0), np.inf)
        if best is None:
            best, gap, done, lost, between = found, here, settled, rounding, apart
        else:
            better = ~done & (settled | (here < np.minimum(gap, some)) | ~np.isfinite(best))
            best, gap = np.where(better, found, best), np.where(better, here, gap)
            lost, between = np.where(better, rounding, lost), np.where(better, apart, between)
            done = done | settled
        if done.all():
            break
    assert best is not None

    def wider(times: float) -> tuple[Array, Array, NDArray[np.bool_]]:
        found, _, rounding, settled = _compared(value, order, reach * times, grain)
        return found, rounding, settled

    best, left = tiny.with_more_digits(best, lost, wider, room)
    if unsure is None:
        return best
    off = np.where(done | (left < lost), left, np.maximum(left, between))
    return np.asarray(best + off * unsure.uniform(-1.0, 1.0, best.shape))


def _compared(
    value: Callable[[float], Array], order: int, reach: float, grain: Array | float
) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Of steps in proportion to `reach`: the derivative, how far two stencils are apart, what rounding makes of it, and
    where they agree."""
    outer, inner = stencil(order), stencil(order, 1 if order == 1 else HALF_WIDTHS[order] - 1)
    h = STEPS[order] * reach
    values = {k: np.asarray(value(k * h), dtype=float) for k, _ in outer}
    scale = h if order == 1 else elementary.pow(h, order)
    found, within = weighted(outer, values) / scale, weighted(inner, values) / scale
    largest = np.max([np.abs(v) for v in values.values()], axis=0)
    largest = largest.max() if order == 1 else largest
    rounding = sum(abs(weight) for _, weight in inner) * (ROUNDING[order] * largest + grain) / scale
    apart = np.abs(found - within)
    settled = apart <= (RESOLVED_SLOPE if order == 1 else RESOLVED) * np.abs(found) + rounding
    return found, apart, np.broadcast_to(rounding, found.shape), settled


def weighted(rule: tuple[tuple[int, float], ...], values: Mapping[int, Array]) -> Array:
    """The sum of weights times values."""
    total = np.zeros_like(values[rule[0][0]])
    for place, weight in rule:
        total = total + weight * values[place]
    return total
