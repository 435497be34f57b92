"""A connecting orbit from samples: a table of times and states, or a long periodic orbit cut at its saddle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NoSolutionError
from contin.homoclinic.guesses import Between
from contin.problems.orbits.mesh.layout import Profile

FIRST: Final = 120  # intervals that the samples are laid on
CLOSED: Final = 1e-2  # part of the extent by which the last sample of a closed orbit may miss the first
FARTHEST: Final = 0.5  # ... and the ends of a connecting orbit their saddles
CUT: Final = 1e-3  # ... nearer than which the tails are left away


@dataclass(frozen=True, eq=False)
class Path:
    """Times (K,), growing, and states (K, n)."""

    times: Array
    states: Array

    def checked(self, n: int) -> Path:
        """As arrays; InputError where they are no samples of an orbit in n dimensions."""
        t, u = np.asarray(self.times, dtype=float), np.asarray(self.states, dtype=float)
        if t.ndim != 1 or u.shape != (len(t), n) or len(t) < 8 or not np.all(np.diff(t) > 0.0):
            raise InputError(
                f"samples of a connecting orbit: at least 8 growing times and as many states of {n} components; got "
                f"shapes {t.shape} and {u.shape}"
            )
        if not np.all(np.isfinite(u)):
            raise InputError("samples of a connecting orbit must be finite")
        if float(np.ptp(u, axis=0).max()) == 0.0:
            raise InputError("samples of a connecting orbit: all states are the same")
        return Path(t, u)

    def at(self, s: Array) -> Array:
        """States between the samples, at scaled times."""
        from scipy.interpolate import PchipInterpolator

        clock = (self.times - self.times[0]) / (self.times[-1] - self.times[0])
        return np.asarray(PchipInterpolator(clock, self.states, axis=0)(np.clip(s, 0.0, 1.0)))


def as_profile(path: Path, between: Between, parameter: float) -> Profile:
    """The part of the samples that leads from the first saddle to the second one.

    Of a closed orbit (first and last sample alike, away from the saddle) it begins and ends where that is nearest to
    the saddle. Intervals of equal parts of the way in time and in space follow fast and slow stretches.
    """
    path = path.checked(between.system.n)
    t, u = path.times, path.states
    sizes, (u0, u1) = between.sizes, between.saddles
    extent = float(np.max(np.ptp(u, axis=0) / sizes))
    from_first = np.max(np.abs(between.apart(u, u0)) / sizes, axis=1) / extent
    closed = float(np.max(np.abs(between.apart(u[-1], u[0])) / sizes)) < CLOSED * extent
    nearest = int(np.argmin(from_first))
    if between.is_loop and closed and from_first[0] > max(CUT, 2.0 * float(from_first[nearest])):
        t, u = _rolled(t, u, nearest)
        from_first = np.max(np.abs(between.apart(u, u0)) / sizes, axis=1) / extent
    from_last = np.max(np.abs(between.apart(u, u1)) / sizes, axis=1) / extent
    for words, gap in (("begins", float(from_first[0])), ("ends", float(from_last[-1]))):
        if gap > FARTHEST:
            raise NoSolutionError(
                f"the orbit given {words} at {gap:.2g} of its extent from its saddle: samples must lead from the first "
                "saddle to the second one"
            )
    away, arrived = np.flatnonzero(from_first > CUT), np.flatnonzero(from_last > CUT)
    chosen = slice(max(int(away[0]) - 1, 0), int(arrived[-1]) + 2)
    t, u = t[chosen], u[chosen]
    u = u - (u[0] - u0 - between.apart(u[0], u0))
    return laid(t, u, sizes, parameter)


def _rolled(t: Array, u: Array, first: int) -> tuple[Array, Array]:
    """A closed orbit that begins at another sample; angles go on growing."""
    gained = u[-1] - u[0]
    u = np.concatenate([u[first:-1], u[: first + 1] + gained])
    t = np.concatenate([t[first:-1], t[: first + 1] + (t[-1] - t[0])])
    return t - t[0], u


def laid(t: Array, u: Array, sizes: Array, parameter: float) -> Profile:
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(u / sizes, axis=0), axis=1))])
    clock = (t - t[0]) / (t[-1] - t[0])
    progress = 0.5 * (clock + way / way[-1])
    edges = np.interp(np.linspace(0.0, 1.0, FIRST + 1), progress, clock)
    h = np.diff(edges)
    empty = Profile(4, np.empty((4 * FIRST + 1, u.shape[1])), float(t[-1] - t[0]), h / h.sum(), parameter)
    return Profile(4, Path(t, u).at(empty.times), empty.period, empty.h, parameter)
