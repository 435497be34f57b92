"""Tests of orbit and inclination flips of homoclinic orbits: the part of a solution along a leading direction.

Towards an end a solution x (the orbit's distance from its saddle, or the bounded solution of the adjoint variational
equation) decays like c v exp(-r |t - t0|): v and r of the leading eigenvalue, t0 the time of its last hump as large as
half of its largest value X. The test is c in units of X,

    (w' x(end) / |w|) / X  exp(r |t - t0|),    w the eigenvector that is paired with v,

smooth through its zero. (The cosine of the angle between w and x(end) is +1 or -1 but for an interval as wide as the
ratio of the leading part to the others, exponentially small in the length of the orbit's ends: a step.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.homoclinic.subspaces import Leading, aligned
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile

ROUNDING: Final = 4.0 * float(np.finfo(float).eps)  # of a vector's part along a direction, relative to the vector
LARGEST: Final = 300.0  # exponent of the growth that is taken out: e^300 is a number still


@dataclass(frozen=True, eq=False)
class End:
    """A solution at an end of its interval, relative to its largest value, and the time between the two."""

    vector: Array
    time: float


Ends = tuple[End | None, End | None]  # at the beginning and at the end; None: not known there


def ends_of_orbit(profile: Profile, termini: tuple[Array, Array], sizes: Array) -> Ends:
    """Of the distances of an orbit's ends from the saddles, relative to where it is farthest from both."""
    first, last = ((profile.u - terminus) / sizes for terminus in termini)
    lengths = np.minimum(np.linalg.norm(first, axis=1), np.linalg.norm(last, axis=1))
    size, times = float(lengths.max()), profile.times * profile.period
    if not size > 0.0:
        return None, None
    away, home = _large(lengths, times)
    return End(first[0] / size, away - float(times[0])), End(last[-1] / size, float(times[-1]) - home)


def ends_of_adjoint(profile: Profile, adjoint: Array, least: float) -> Ends:
    """Of the bounded adjoint solution at the Gauss points, where it is above `least` of its largest value."""
    lengths, times = np.linalg.norm(adjoint, axis=1), profile.gauss_times * profile.period
    size = float(lengths.max())
    known = np.flatnonzero(lengths > least * size)
    if not known.size:
        return None, None
    first, last, (away, home) = int(known[0]), int(known[-1]), _large(lengths, times)
    return End(adjoint[first] / size, away - float(times[first])), End(adjoint[last] / size, float(times[last]) - home)


def _large(lengths: Array, times: Array) -> tuple[float, float]:
    """The times of the first and the last hump of a solution that has half of its largest size.

    Of two loops that are nearly as large, rounding says which is the larger one: the time of that jumps.
    """
    sides = np.concatenate([[-np.inf], lengths, [-np.inf]])
    humps = (lengths >= sides[:-2]) & (lengths >= sides[2:]) & (lengths >= 0.5 * float(lengths.max()))
    places = np.flatnonzero(humps)
    return float(times[places[0]]), float(times[places[-1]])


def component(memory: dict[str, Array], name: str, slow: Leading, direction: Array, end: End | None) -> float:
    """The test of the module's head along a direction whose sense is kept; none (NaN) where the direction turns."""
    if end is None or not slow.is_real:
        memory.pop(name, None)
        return float("nan")
    unit = aligned(direction / float(np.linalg.norm(direction)), memory.get(name))
    memory[name] = unit
    part = float(unit @ end.vector)
    if abs(part) <= ROUNDING * float(np.linalg.norm(end.vector)):
        return 0.0  # no sign of its own: the orbit (the adjoint solution) lies in an invariant plane
    growth = elementary.exp(min(abs(slow.value.real) * end.time, LARGEST))
    return part * float(growth)
