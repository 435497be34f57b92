"""How a connecting orbit goes on beyond its interval: along the slowest direction of the saddle, and faster ones.

The part c along the slowest real eigenvector obeys c' = r c + a c^2 up to third order, which holds as well where r is
small beside a c (a saddle next to a fold) and where r = 0 (a saddle-node):

    c(t) = r c0 e^(r t) / (r + a c0 (1 - e^(r t))),      r = 0:  c(t) = c0 / (1 - a c0 t)

All other parts obey the linear equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.problems.orbits.ends.saddle_node import quadratic

if TYPE_CHECKING:
    from contin.homoclinic.equations import ConnectionCurve

LONGEST = 30.0  # time of a tail in units of the slowest rate, where there is one
STILL = 1e-9  # a rate this small beside that of c^2 is zero


@dataclass(frozen=True, eq=False)
class Tail:
    """Offsets from the saddle at times after (before) an end; rates are those of the time that leads away from it."""

    rate: float
    quadratic: float
    start: float  # c0
    shrink: float  # factor by which c is to fall; 1 where it is small already
    slow: Array  # (n,) right eigenvector, in the states' units
    rates: NDArray[np.complex128]
    fast: NDArray[np.complex128]  # (n, k) other parts of the offset, each along an eigenvector
    least: float = 0.0  # time that the other parts need

    def times(self, parts: Array) -> Array:
        """Moments from 0 to the tail's end: when c has fallen by shrink^parts, evenly spaced where c is not slowest."""
        slow = self._slow(parts)
        return slow if slow[-1] > self.least else self.least * parts

    def _slow(self, parts: Array) -> Array:
        r, b = self.rate, self.quadratic * self.start
        factors = elementary.pow(self.shrink, parts)
        if self._is_neutral:
            return np.asarray((1.0 - 1.0 / factors) / b) if b != 0.0 else np.full(len(parts), np.nan)
        with np.errstate(invalid="ignore", divide="ignore"):
            times = elementary.log(factors * (r + b) / (r + b * factors)) / r
        return np.asarray(times)

    @property
    def _is_neutral(self) -> bool:
        """True where the rate is zero, beside what c^2 does even at the end of the tail: a saddle-node."""
        return abs(self.rate) < STILL * self.shrink * abs(self.quadratic * self.start)

    def offsets(self, times: Array) -> Array:
        """(len(times), n)"""
        r, b = self.rate, self.quadratic * self.start
        with np.errstate(all="ignore"):  # what does not come out finite is not used
            if self._is_neutral:
                c = self.start / (1.0 - b * times)
            else:
                grown = elementary.exp(r * times)
                c = r * self.start * grown / (r + b * (1.0 - grown))
        others = np.real(elementary.exp(np.outer(times, self.rates)) @ self.fast.T)
        return np.asarray(c[:, None] * self.slow + others)


def tail_of(
    curve: ConnectionCurve, z: Array, sizes: Array, saddle: Array, offset: Array, at_end: bool, shrink: float
) -> Tail:
    """The tail of an orbit whose end is `offset` away from the saddle, for that to fall by a factor."""
    matrix = curve.scaled_matrix(saddle, z, sizes)
    sign = 1.0 if at_end else -1.0
    pairs = np.linalg.eig(sign * matrix)
    values, vectors = pairs[0].astype(complex), pairs[1].astype(complex)
    parts = np.linalg.solve(vectors, (offset / sizes).astype(complex))
    aim = shrink * float(np.max(np.abs(offset / sizes)))
    order = np.argsort(-values.real)
    count = curve.unstable_count if at_end else curve.stable_count  # of the directions that lead away: left out
    kept = order[count:]
    k, others = kept[0], kept[1:]
    if values[k].imag != 0.0:
        rate, q, start, bend = float(values[k].real), np.zeros(curve.n), 0.0, 0.0
        others = kept
    else:
        rate, q = float(values[k].real), np.real(vectors[:, k])
        left, p = np.real(np.linalg.inv(vectors)[k]), curve.full_parameters(z)
        start, bend = float(parts[k].real), sign * quadratic(curve.orbits.system, saddle, p, sizes, left, q)
    fast: NDArray[np.complex128] = (vectors[:, others] * parts[others] * sizes[:, None]).astype(complex)
    rates = values[others]
    others_now = np.abs(fast / sizes[:, None]).max(axis=0, initial=0.0)
    needed = np.minimum(elementary.log(np.maximum(others_now / aim, 1.0)), LONGEST) / -rates.real
    least = float(np.max(needed, initial=0.0))
    factor = min(aim / max(abs(start) * float(np.max(np.abs(q))), 1e-300), 1.0)
    tail = Tail(rate, bend, start, factor, q * sizes, rates, fast, least)
    last = tail.times(np.ones(1))[0]
    if not (last > 0.0 and (rate >= 0.0 or last < -LONGEST / rate or bend * start < 0.0)):
        factor = max(factor, float(elementary.exp(-LONGEST)))
        return Tail(rate, 0.0, start, factor, q * sizes, rates, fast, least)
    return tail
