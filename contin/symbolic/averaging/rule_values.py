"""The values of quadrature rules at sample amplitudes, in numbers: they decide how many nodes the formulas get.

The same rules as `gauss_rule` and `piecewise_turn` write as formulas, evaluated without writing them: a rule with 512
nodes is one formula at 512 values of the angle, and hundreds of thousands of expressions to build.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.machine import elementary
from contin.model.expression import Expression, symbol
from contin.records import Record
from contin.symbolic.averaging.gauss_rule import Array, cosine_of_node, gauss
from contin.symbolic.calculus.sampling import sample

COS: Final = symbol("@cos")
SIN: Final = symbol("@sin")
"""Cosine and sine of the angle, in the formula of an integrand."""

Values = Record  # of symbols: numbers, or arrays of shape (k,) for k amplitudes


@dataclass(frozen=True)
class Segment:
    """An integrand, a formula in COS and SIN, between two angles, numbers or formulas in the amplitudes."""

    start: Expression | float
    stop: Expression | float
    integrand: Expression


def turn_values(integrand: Expression, n: int, values: Values, half: bool = False, harmonic: int = 1) -> Array:
    """Means of f sin(h phi) and f cos(h phi) over 2n equidistant nodes of the turn, (2, k); h is the `harmonic`.

    half : only the n nodes of the first half, for an odd f.
    """
    count = n if half else 2 * n
    c = np.array([cosine_of_node(k, n) for k in range(count)])[:, None]
    s = np.array([cosine_of_node((k - n // 2) % (2 * n), n) for k in range(count)])[:, None]
    f = sample([integrand], {**values, "@cos": c, "@sin": s})[0]
    c, s = _multiple(c, s, harmonic)
    return np.array([np.sum(f * s, axis=0), np.sum(f * c, axis=0)]) / count


def _multiple(c: Array, s: Array, harmonic: int) -> tuple[Array, Array]:
    if harmonic == 1:
        return c, s
    turned = np.ones_like(c + 1j * s)
    for _ in range(harmonic):
        turned = turned * (c + 1j * s)
    return turned.real, turned.imag


def arc_values(segments: Sequence[Segment], n: int, values: Values, fold: int = 1, harmonic: int = 1) -> Array:
    """Averages of f sin(h phi) and f cos(h phi) over the turn by n Gauss nodes on every segment, (2, k).

    f is 0 outside the segments.
    """
    nodes, weights = gauss(n)
    shape = np.broadcast_shapes(*(np.shape(v) for v in values.values()))
    total = np.zeros((2, *shape))
    for segment in segments:
        start, stop = (
            sample([end], values)[0] if isinstance(end, Expression) else np.full(shape, end)
            for end in (segment.start, segment.stop)
        )
        middle, spread = 0.5 * (start + stop), 0.5 * (stop - start)
        angle = middle + nodes[:, None] * spread
        c, s = np.asarray(elementary.cos(angle)), np.asarray(elementary.sin(angle))
        f = sample([segment.integrand], {**values, "@cos": c, "@sin": s})[0]
        c, s = _multiple(c, s, harmonic)
        factor = fold / (2 * math.pi) * weights[:, None] * spread
        total += np.array([np.sum(factor * f * s, axis=0), np.sum(factor * f * c, axis=0)])
    return total
