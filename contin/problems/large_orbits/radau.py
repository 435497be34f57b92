"""The collocation of an orbit: Radau points, three in each interval, order 5 at its end (Hairer and Wanner, Solving
Ordinary Differential Equations II, sec. IV.5).

The end of an interval is its last point, so values there are unknowns and what decays fast decays in one interval: the
multipliers of stiff modes are 0, as those of the flow. Gauss points would give them modulus 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import Final

import numpy as np

from contin.abi import Array

STAGES: Final = 3
_ROOT: Final = sqrt(6.0)
C: Final = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
A: Final = np.array(
    [
        [(88.0 - 7.0 * _ROOT) / 360.0, (296.0 - 169.0 * _ROOT) / 1800.0, (-2.0 + 3.0 * _ROOT) / 225.0],
        [(296.0 + 169.0 * _ROOT) / 1800.0, (88.0 + 7.0 * _ROOT) / 360.0, (-2.0 - 3.0 * _ROOT) / 225.0],
        [(16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0],
    ]
)
WEIGHTS: Final = A[2]  # of integrals over an interval of length 1
INVERSE: Final = np.linalg.inv(A)
_NODES: Final = np.append(0.0, C)
_POWERS: Final = np.linalg.inv(np.vander(_NODES, increasing=True))  # coefficients of the cubic through four values


def extremes(values: Array) -> Array:
    """Smallest and largest value (2, k) over a period of cubics that have these values (intervals, 3, k) at the points.

    Of order 4 in the length of the intervals, where those of the points are of order 2.
    """
    four = np.concatenate([np.roll(values[:, -1], 1, axis=0)[:, None], values], axis=1)
    c = np.einsum("ab,jbk->ajk", _POWERS, four)
    with np.errstate(all="ignore"):
        root = np.sqrt(c[2] * c[2] - 3.0 * c[1] * c[3])
        q = -(c[2] + np.copysign(root, c[2]))
        places = np.array([q / (3.0 * c[3]), c[1] / q])
    x = np.where((places > 0.0) & (places < 1.0), places, 0.0)
    at = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    every = np.concatenate([four.reshape(-1, values.shape[-1]), at.reshape(-1, values.shape[-1])])
    return np.array([every.min(axis=0), every.max(axis=0)])


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One period: U (intervals, 3, n) at the points, the end of each interval last.

    It begins at the end of the last interval. `lengths` of the intervals as parts of the period; None: equal ones.
    `beginnings` (intervals, n): values where intervals begin; None: where those before them end.
    """

    U: Array
    period: float
    lengths: Array | None = None
    starts: Array | None = None

    def integral(self, values: Array) -> float:
        """Over the period of a function with these values (intervals * 3,) at the points."""
        return self.period * float(np.einsum("j,k,jk->", self.h, WEIGHTS, values.reshape(-1, STAGES)))

    @cached_property
    def h(self) -> Array:
        """Lengths (intervals,) as parts of the period."""
        count = len(self.U)
        return np.full(count, 1.0 / count) if self.lengths is None else self.lengths

    @property
    def beginnings(self) -> Array:
        """Values (intervals, n) at the beginning of each interval."""
        return np.roll(self.U[:, 2], 1, axis=0) if self.starts is None else self.starts

    @property
    def slopes(self) -> Array:
        """Derivatives (intervals, 3, n) by the time in periods, of the interpolating polynomials."""
        return np.asarray(np.einsum("ik,jkn->jin", INVERSE, self.U - self.beginnings[:, None]) / self.h[:, None, None])

    @cached_property
    def mesh(self) -> Array:
        """(intervals + 1,), from 0 to 1."""
        mesh = np.append(0.0, np.cumsum(self.h))
        mesh[-1] = 1.0
        return mesh

    @property
    def times(self) -> Array:
        """(3 intervals + 1,), from 0 to 1."""
        return np.append(0.0, (self.mesh[:-1, None] + self.h[:, None] * C).ravel())

    @property
    def u(self) -> Array:
        """(3 intervals + 1, n) at `times`."""
        return np.vstack([self.beginnings[0], self.U.reshape(-1, self.U.shape[2])])

    def at(self, times: Array) -> Array:
        """Values (K, n) at times from 0 to 1."""
        asked = np.asarray(times, dtype=float)
        j = np.clip(np.searchsorted(self.mesh, asked, side="right") - 1, 0, len(self.U) - 1)
        x = ((asked - self.mesh[j]) / self.h[j])[:, None]
        weights = np.ones((len(x), 4))
        for k in range(4):
            for other in range(4):
                if other != k:
                    weights[:, k : k + 1] *= (x - _NODES[other]) / (_NODES[k] - _NODES[other])
        values = np.concatenate([self.beginnings[:, None], self.U], axis=1)[j]
        return np.asarray(np.einsum("tk,tkn->tn", weights, values))

    def refined(self, intervals: int) -> Trajectory:
        """The same on another number of equal intervals."""
        times = ((np.arange(intervals)[:, None] + C) / intervals).ravel()
        return Trajectory(self.at(times).reshape(intervals, STAGES, -1), self.period)
