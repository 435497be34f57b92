"""A connecting orbit between two given saddles, from trajectories in the unstable manifold of the first one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.departure import Seed
from contin.errors import InputError, NotFiniteError
from contin.machine import elementary
from contin.problems.orbits.homoclinic.curve import ConnectionCurve
from contin.problems.orbits.homoclinic.solved import solved_connection
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.two_parameters import indices
from contin.simulate.natural import natural_metric
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

LEAVING: Final = 1e-4  # distance from the saddle at which trajectories start, of that of the saddles; of loops of 1
AWAY: Final = 0.3  # ... that a loop must reach before its return counts (all in the states' sizes)
ANGLES: Final = 64  # directions in a plane of unstable directions
LONGEST: Final = 60.0  # times of the slowest unstable rate
SAMPLES: Final = 4000
INTERVALS: Final = 60
ONE_SADDLE: Final = 1e-8  # of the states' sizes: saddles this near are one
NEAR: Final = 0.3  # relative distance from the second saddle at which a connection is looked for


@dataclass(frozen=True, eq=False)
class ConnectingOrbit:
    """Two saddles (the same one for a homoclinic orbit) at parameters near those of an orbit that connects them."""

    system: CompiledSystem
    p: Array
    saddles: Array  # (2, n)

    def locus(self, parameters: tuple[str, str]) -> list[Seed]:
        """The curve of connecting orbits in two parameters, which starts at the present value of the second one."""
        first, second = indices(self.system, parameters)
        rates = [np.linalg.eigvals(self._matrix(u)).real for u in self.saddles]
        stable, unstable = int(np.sum(rates[0] < 0.0)), int(np.sum(rates[1] > 0.0))
        orbits = OrbitProblem(self.system, self.p.copy(), first, np.zeros(self.system.n), 4)
        piece = self._trajectory(float(self.p[first]))
        ends = self.saddles[:1] if self.is_loop else self.saddles
        curve = ConnectionCurve(orbits, second, len(ends), stable, unstable)
        return [solved_connection(curve, piece, ends, float(self.p[second]), None)]

    @property
    def is_loop(self) -> bool:
        return bool(np.all(np.abs(self.saddles[0] - self.saddles[1]) <= ONE_SADDLE * self.sizes))

    @cached_property
    def sizes(self) -> Array:
        """Of the states (n,), in which all lengths are measured: natural ones at the first saddle, or the saddles'."""
        natural = natural_metric(self.system, self.saddles[0], self.p).states
        return np.asarray(np.maximum(natural, np.abs(self.saddles).max(axis=0)))

    def _matrix(self, u: Array) -> Array:
        return np.asarray(self.system.jacobian(u, self.p)[1][:, : self.system.n])

    def _trajectory(self, parameter: float) -> Profile:
        """The trajectory of those tried that comes nearest to the second saddle, up to there."""
        u0, u1 = self.saddles
        d = self.sizes
        values, vectors = np.linalg.eig(self._matrix(u0) * d / d[:, None])
        growing = values.real > 0.0
        if not growing.any():
            raise InputError("the first equilibrium has no unstable direction: no orbit leaves it")
        extent = 1.0 if self.is_loop else float(np.linalg.norm((u1 - u0) / d))
        duration = LONGEST / float(values.real[growing].min())
        times = np.linspace(0.0, duration, SAMPLES)
        best: tuple[float, Array, int] = (np.inf, np.empty(0), 0)
        for direction in _directions(vectors[:, growing]):
            start = u0 + LEAVING * extent * direction * d
            path = _until_lost(self.system, start, self.p, times)
            gone = np.linalg.norm((path - u0) / d, axis=1)
            begin = _turning(gone, AWAY * extent) if self.is_loop else 0
            if begin is None:
                continue
            gaps = np.linalg.norm((path[begin:] - u1) / d, axis=1)
            k = int(np.argmin(gaps))
            reach = float(gone.max()) if self.is_loop else extent
            if gaps[k] / reach < best[0] and begin + k > 1:
                best = float(gaps[k]) / reach, start, begin + k
        if best[0] > NEAR:
            raise InputError(
                "no connecting orbit nearby: trajectories that leave the first saddle pass the second one at "
                f"{best[0]:.2g} of their extent; change the parameters so that they come nearer"
            )
        time = float(times[best[2]])
        h = np.full(INTERVALS, 1.0 / INTERVALS)
        empty = Profile(4, np.empty((4 * INTERVALS + 1, self.system.n)), time, h, parameter)
        whole = integrate(self.system, best[1], self.p, time * (1.0 + 1e-12), times=empty.times * time)
        return Profile(4, whole.u, time, h, parameter)


def _turning(gone: Array, away: float) -> int | None:
    """Where the distance from a saddle first falls again, having exceeded `away`; None where it never does."""
    falls = np.flatnonzero((gone[:-1] > away) & (gone[1:] < gone[:-1]))
    return int(falls[0]) if falls.size else None


def _directions(vectors: Array) -> list[Array]:
    """Unit vectors in the unstable eigenspace: both senses of a line, a circle in a plane."""
    left, values, _ = np.linalg.svd(np.hstack([vectors.real, vectors.imag]), full_matrices=False)
    basis = left[:, : max(1, int(np.sum(values > 1e-9 * values[0])))]
    if basis.shape[1] == 1:
        return [basis[:, 0], -basis[:, 0]]
    angles = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    return [elementary.cos(a) * basis[:, 0] + elementary.sin(a) * basis[:, 1] for a in angles]


def _until_lost(system: CompiledSystem, u: Array, p: Array, times: Array) -> Array:
    """States at the times, as far as the trajectory has a value."""
    duration, count = float(times[-1]), len(times)
    while count > 10:
        try:
            return np.asarray(integrate(system, u, p, duration, times=times[:count], budget=100_000).u)
        except NotFiniteError:
            count = (count * 2) // 3
            duration = float(times[count - 1])
    return u[None]
