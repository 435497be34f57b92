"""Distances of states in units of their sizes: of angles but for whole turns, in a frame but for a small turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.orbits.march.slow_passage import turning
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

NEAR_SADDLE = 0.1  # of the orbit's extent: how close it comes to a saddle that it lingers at


def turns(problem: FamilyOfOrbits, difference: Array) -> Array:
    """The whole turns of angles in a difference of states (rows of them); 0 for other states."""
    periods = np.asarray(problem.system.model.periods(problem.constants()), dtype=float)
    count = np.round(difference / np.where(periods > 0.0, periods, 1.0))
    return np.asarray(np.where(periods > 0.0, count * periods, 0.0))


def apart(problem: FamilyOfOrbits, u: Array, v: Array) -> Array:
    return np.asarray(u - v - turns(problem, u - v))


def distance(problem: FamilyOfOrbits, u: Array, v: Array, sizes: Array) -> float:
    """Largest difference of two states relative to their sizes, in a turning frame: but for a small turn."""
    return float(distances(problem, u, v[None], sizes)[0])


def distances(problem: FamilyOfOrbits, u: Array, states: Array, sizes: Array) -> Array:
    """The same of a state (n,) and each of K states (K, n)."""
    gaps = apart(problem, u, states) / sizes
    along = turning(problem, states)
    if along is not None:
        xi = along / sizes
        squares = np.sum(xi * xi, axis=1)
        parts = np.sum(gaps * xi, axis=1) / np.where(squares > 0.0, squares, 1.0)
        gaps = gaps - parts[:, None] * xi
    return np.asarray(np.max(np.abs(gaps), axis=1))


def extent_of(profile: Profile, sizes: Array) -> float:
    """Of an orbit, relative to the states' sizes."""
    return float(np.max(np.ptp(profile.u, axis=0) / sizes))
