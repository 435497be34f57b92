"""Functions much smaller at an end of their interval than elsewhere: end values are asked for, in their own size.

An error relative to the largest value of a function says nothing about u'(0) = 1.6e-8 where u'(1) = 2.2e4 (Troesch's
problem, mu = 20). Where errors grow and decay like the solution, an end value is as accurate, in its own size, as the
solution is all the way, in the size that it has reached from there: the mesh follows that. For exponential growth it
costs a number of intervals proportional to the logarithm.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_basis import basis
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import TINY_STATE

SMALL: Final = 1e-3  # of its largest modulus: an end value that errors relative to the largest do not tell
ROUNDED: Final = 1e-14  # ... and one that is zero but for rounding
FLOOR: Final = 1e-11  # of its largest modulus, below which differences of a function are rounding


def towards_small_ends(profile: Profile, sizes: Array, states: int | None = None) -> Array:
    """Largest |u^(m + 1)| on every interval relative to the sizes reached from small ends, (intervals,); 0 without any.

    sizes (n,) : a function that is much smaller all along is zero but for rounding.  states : the number of functions
    whose end values are asked for, the first ones; of null vectors beside them they are not.
    """
    largest = np.abs(profile.u).max(axis=0)
    counted = (largest > TINY_STATE * sizes) & (np.arange(profile.n) < (profile.n if states is None else states))
    found = np.zeros(profile.intervals)
    for sense in (1, -1):
        end = np.abs(profile.u[0 if sense == 1 else -1])
        if not np.any(counted & (end < SMALL * largest) & (end > ROUNDED * largest)):
            continue
        u = profile.u[::sense, counted]
        nodes = np.arange(profile.intervals)[:, None] * profile.m + np.arange(profile.m + 1)
        reached = np.maximum.accumulate(np.abs(u)[nodes].max(axis=1))
        size = np.maximum(reached, FLOOR * largest[counted])[::sense]
        found = np.maximum(found, (_top(profile, counted) / size).max(axis=1))
    return found


def error_at_small_ends(profile: Profile, sizes: Array) -> float:
    """Largest error inside an interval, relative to the sizes that functions have reached from small ends."""
    if profile.intervals < 2:
        return 0.0
    lengths = elementary.pow(profile.h, profile.m + 1)
    return float(np.max(basis(profile.m).error * lengths * towards_small_ends(profile, sizes)))


def _top(profile: Profile, counted: Array) -> Array:
    """|u^(m + 1)| of functions on every interval, (intervals, k): of jumps of the highest derivative at its ends."""
    h, m = profile.h, profile.m
    nodes = np.arange(profile.intervals)[:, None] * m + np.arange(m + 1)
    top = np.einsum("j,ijk->ik", basis(m).top, profile.u[nodes][:, :, counted]) / elementary.pow(h[:, None], m)
    jumps = 2.0 * np.abs(np.diff(top, axis=0)) / (h[1:] + h[:-1])[:, None]
    return np.asarray(np.maximum(np.vstack([jumps[:1], jumps]), np.vstack([jumps, jumps[-1:]])))
