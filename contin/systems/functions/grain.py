"""How coarse the values of a function are: rounded to some digits, iterated to a tolerance, or noisy.

Noise shows in differences of high order of values at even places, where what is smooth has vanished (Hamming,
*Introduction to Applied Numerical Analysis*; More and Wild, *SIAM J. Sci. Comput.* 33 (2011) 1292). The same at places
a hundred times closer must show it too: a corner between the places does not, nor what bends over lengths between.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array, Vector

ORDER: Final = 6  # of the differences
SPACINGS: Final = (1e-4, 1e-6)  # relative: steps of up to 1e-6 of a value are seen, and noise of any size
RATIOS: Final = (1.0, 0.6180339887, 0.7548776662)  # ... each in three lengths: one may be a whole number of steps
BOUND: Final = 4.0  # standard deviations; half a step of evenly spread rounding is 1.7
GRAINY: Final = 1e-11  # of what a component changes by: more is no rounding of double precision


def grain(values: Callable[[Array], Array]) -> Array:
    """Bounds of what components (k,) are off by at random; `values` (m, k) at m places t (m,) of a line.

    t = 1 moves arguments by their own sizes, all of them: a component that does not change shows nothing.
    """
    found = _deviations(values, np.multiply.outer(SPACINGS, RATIOS))
    return np.asarray(BOUND * found.max(axis=1).min(axis=0))


def glance(values: Callable[[Array], Array]) -> Array:
    """`grain` at places of one distance, the nearest: few values, which show whether there is any."""
    return np.asarray(BOUND * _deviations(values, np.array([[SPACINGS[-1] * RATIOS[1]]]))[0, 0])


def _deviations(values: Callable[[Array], Array], lengths: Array) -> Array:
    """Standard deviations of components (a, b, k) from values at places so far apart (a, b); 0 where there are none."""
    places = np.arange(ORDER + 2) - 0.5 * (ORDER + 1)
    table = np.asarray(values(np.multiply.outer(lengths, places).ravel()), dtype=float)
    last = np.diff(table.reshape(*lengths.shape, len(places), -1), ORDER, axis=2)
    found = np.sqrt(np.mean(last * last, axis=2) / math.comb(2 * ORDER, ORDER))
    return np.where(np.isfinite(found), found, 0.0)


def generic_line(sizes: Array) -> Array:
    """A direction in which all arguments move by about their sizes, (k,)."""
    signs = np.random.default_rng(29).uniform(0.5, 1.0, sizes.size)
    signs[1::2] *= -1.0
    return np.asarray(sizes * signs)


@dataclass(eq=False)
class Grain:
    """What a function F(u, p) (n,) is off by, at places (u, p); `sizes` (n + m,) are typical ones of u and p."""

    function: Callable[[Vector, Vector], Vector]
    sizes: Array
    _last: tuple[bytes, Array] = field(default=(b"", np.empty(0)), repr=False)

    def at(self, u: Array, p: Array) -> Array:
        """Of every component, (n,)."""
        key = u.tobytes() + p.tobytes()
        if key != self._last[0]:
            n, line = len(u), generic_line(np.maximum(np.abs(np.concatenate([u, p])), self.sizes))
            places = lambda t: np.array([self.function(u + x * line[:n], p + x * line[n:]) for x in t])  # noqa: E731
            self._last = key, grain(places)
        return self._last[1]

    def relative(self, u: Array, p: Array) -> float:
        """The largest, of what that component changes by while arguments move by a tenth; 0 where it is rounding."""
        n, line = len(u), 0.1 * generic_line(np.maximum(np.abs(np.concatenate([u, p])), self.sizes))
        here, there = (np.asarray(self.function(u + x * line[:n], p + x * line[n:]), dtype=float) for x in (0.0, 1.0))
        change = np.maximum(np.abs(there - here), np.finfo(float).tiny)
        found = float(np.max(self.at(u, p) / change, initial=0.0))
        return found if GRAINY < found < np.inf else 0.0
