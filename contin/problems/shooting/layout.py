"""How shooting stores an orbit in one vector: z = (u_1 .. u_M, T, normal, offset, p).

u_i is the state at the scaled time (i - 1) / M. The phase is fixed by the plane normal . u_1 = offset, which is part of
z (so every point of a branch knows its own and the engine needs to know of none); tangents do not move it. For a forced
system the plane is zero: its phase is that of the forcing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

WEIGHTLESS = 1e300  # scale of what does not move: it counts for nothing in the metric


@dataclass(frozen=True, eq=False)
class Nodes:
    """An orbit as shooting knows it: states u (M, n), period, section, parameter."""

    u: Array
    period: float
    normal: Array
    offset: float
    parameter: float

    @property
    def count(self) -> int:
        """Segments M."""
        return len(self.u)

    def vector(self) -> Array:
        """z."""
        return np.concatenate([self.u.ravel(), [self.period], self.normal, [self.offset, self.parameter]])

    @classmethod
    def of(cls, z: Array, n: int) -> Nodes:
        """Read z."""
        size = len(z) - n - 3
        return cls(z[:size].reshape(-1, n), float(z[size]), z[size + 1 : size + 1 + n], float(z[-2]), float(z[-1]))


def moving(size: int, n: int) -> NDArray[np.intp]:
    """Positions in z of the unknowns that move, (M n + 2,): states, period, parameter."""
    return np.append(np.arange(size - n - 2), size - 1)


def make_scale(sizes: Array, count: int, period: float, parameter: float) -> Array:
    """The metric: |z / scale|^2 = mean over nodes and states of (u / sizes)^2 + (T / period)^2 + (p / parameter)^2."""
    n = len(sizes)
    states = np.tile(np.sqrt(n * count) * sizes, count)
    return np.concatenate([states, [period], np.full(n + 1, WEIGHTLESS), [parameter]])


def sizes_of(scale: Array, n: int) -> Array:
    """The states' sizes that `make_scale` was given."""
    count = (len(scale) - n - 3) // n
    return np.asarray(scale[:n] / np.sqrt(n * count))
