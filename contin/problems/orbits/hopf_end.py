"""The Hopf point that a curve of periodic orbits comes to: beyond it the same orbits follow again, half a turn on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final, Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings

STEPS: Final = 12  # secants to the point
ACCURATE: Final = 1e-3  # arclength to the point; its parameters change by the square of that
TIMES: Final = np.linspace(0.0, 1.0, 64, endpoint=False)
ALIKE: Final = 0.5  # cosine
BLOCK: Final = 100_000  # numbers of rows that are compared at once
SMALL: Final = 1e-2  # relative amplitude below which an orbit is its Hopf point, or one of half its period


class Shape(Protocol):
    """An orbit of any discretisation."""

    @property
    def u(self) -> Array:
        """(points, n)"""

    def at(self, times: Array) -> Array:
        """(K, n) at times from 0 to 1."""


class Shrinking(Protocol):
    """A problem whose solutions are orbits."""

    @property
    def winding(self) -> Array:
        """What each state gains in one period."""

    def profile(self, z: Array) -> Shape:
        """The orbit."""

    def orbit_sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric of z."""

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem`."""


def cut_at_birth(problem: Shrinking, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """The chunk up to the point at which the amplitude of its orbits passes zero, which becomes the last row."""
    if len(chunk) < 2 or problem.winding.any():
        return chunk
    for k in _unlike(problem, chunk.z):
        shape, following = (_deviations(problem, z, frame.scale) for z in chunk.z[k : k + 2])
        if float(np.sum(shape * following)) < 0.0:
            last = _smallest(problem, chunk.sample(k), shape, float(chunk.lengths[k + 1]), frame, settings)
            if last is None:
                return chunk
            return with_last_row(chunk.cut(k + 2, Stop.LIMIT, chunk.next_step), last)
    return chunk


def _unlike(problem: Shrinking, rows: Array) -> Iterator[int]:
    """Rows (K, N) from which to the next one not every state goes up and down alike: most need no closer look."""
    some = max(BLOCK // rows.shape[1], 2)
    for first in range(0, len(rows) - 1, some - 1):
        values = [problem.profile(z).u for z in rows[first : first + some]]
        if len({u.shape for u in values}) > 1:
            yield from range(first, first + len(values) - 1)
            continue
        u = np.array(values)
        u -= np.einsum("kij->kj", u)[:, None] / u.shape[1]
        squares, products = np.einsum("kij,kij->kj", u, u), np.einsum("kij,kij->kj", u[:-1], u[1:])
        alike = (products >= ALIKE * np.sqrt(squares[:-1] * squares[1:])).all(axis=1)
        yield from (first + np.flatnonzero(~alike)).tolist()


def has_shrunk(problem: Shrinking, z: Array, scale: Array) -> bool:
    """True where the orbit is a point, but for an amplitude that does not matter."""
    u = problem.profile(z).u
    return not problem.winding.any() and bool(np.max(np.ptp(u, axis=0) / problem.orbit_sizes(z, scale)) < SMALL)


def is_growing(problem: Shrinking, before: Sample | None, origin: Sample, scale: Array) -> bool:
    """True where the orbit is larger than the one before, and no half turn from it: the curve comes from its birth."""
    if before is None:
        return False
    old, new = (_deviations(problem, sample.z, scale) for sample in (before, origin))
    return 0.0 < float(np.sum(old * old)) <= float(np.sum(old * new))


def _deviations(problem: Shrinking, z: Array, scale: Array) -> Array:
    """u - mean of u, relative to the states' sizes."""
    u = problem.profile(z).at(TIMES)
    return np.asarray((u - u.mean(axis=0)) / problem.orbit_sizes(z, scale))


def _smallest(
    problem: Shrinking, base: Sample, shape: Array, length: float, frame: Frame, settings: Settings
) -> Sample | None:
    """The point within this arclength of the base at which the amplitude, negative beyond zero, vanishes."""
    near = float(np.sum(shape * shape))
    low, high = (0.0, near), (length, np.nan)
    best = None
    for _ in range(STEPS):
        at = high[0] if np.isnan(high[1]) else low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        found = problem.probe(base, at, base.z + at * frame.scale * base.tangent, frame, settings)
        if found is None:
            break
        amplitude = float(np.sum(shape * _deviations(problem, found.z, frame.scale)))
        best = found
        if abs(amplitude) < ACCURATE * near:
            break
        low, high = ((at, amplitude), high) if amplitude > 0.0 else (low, (at, amplitude))
        if np.isnan(high[1]):
            break
    return best


def with_last_row(chunk: Chunk, last: Sample) -> Chunk:
    """The chunk with another last row."""
    z, tangents, unstable = chunk.z.copy(), chunk.tangents.copy(), chunk.unstable.copy()
    eigenvalues = chunk.eigenvalues.copy()
    z[-1], tangents[-1], unstable[-1], eigenvalues[-1] = last.z, last.tangent, last.unstable, last.eigenvalues
    return replace(chunk, z=z, tangents=tangents, unstable=unstable, eigenvalues=eigenvalues)
