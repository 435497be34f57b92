"""Sizes of states from the equations' values: where what is beyond their slopes at rest is as large as the slopes.

For equations whose second and third derivatives at rest vanish (p x - x^5, a clearance that is not reached), which
say nothing of how large the states become.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.systems.protocol import System

DECADES: Final = 60  # ... upwards and downwards from 1: all units that double precision has room for, squares included
HALVINGS: Final = 10  # of the decade: neighbouring units give the same size to 1/300 of itself


def lengths_beyond_slopes(system: System, u: Array, p: Array, slopes: Array, lengths: Array) -> Array:
    """The lengths (n,) with, where they are 0, the least |s| at which |f(u + s e_i) - f(u) - f_u e_i s| is the slopes'
    part in some equation; 0 remains where there is none.

    p : (p_size,), the parameters as the system takes them.  slopes : (n, n), |d f_k / d u_i| as large as they become.
    The difference must grow from less than that, twice: rounding falls with s instead.
    """
    n = len(u)
    f, jacobian = system.jacobian(u, p)
    lengths = lengths.copy()
    if not (np.isfinite(f).all() and np.isfinite(jacobian).all()):
        return lengths

    def beyond(i: int, exponents: Array) -> Array:
        """The largest part of the slopes' that is beyond them, at s = 10^exponents and -s, (len(exponents),)."""
        s = elementary.pow(np.full(len(exponents), 10.0), exponents)
        steps, rows = np.concatenate([s, -s]), slopes[:, i] > 0.0
        places = u + steps[:, None] * np.eye(n)[i]
        values = system.jacobians(places, np.tile(p, (len(steps), 1)))[0]
        with np.errstate(over="ignore", invalid="ignore"):
            off = np.abs(values - f - steps[:, None] * jacobian[:, i])[:, rows]
            part = off / (np.abs(steps)[:, None] * slopes[rows, i])
        part = np.where(np.isnan(part), 0.0, part)  # beyond where the equations are defined
        return np.asarray(part.max(axis=1).reshape(2, -1).max(axis=0))

    exponents = np.arange(-DECADES, DECADES + 1, dtype=float)
    for i in np.flatnonzero((lengths == 0.0) & (slopes > 0.0).any(axis=0)):
        large = beyond(int(i), exponents) >= 1.0
        rises = np.flatnonzero(large[3:] & large[2:-1] & ~large[1:-2] & ~large[:-3])
        if not rises.size:
            continue
        low = exponents[rises[0] + 1]
        high = low + 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if beyond(int(i), np.array([middle]))[0] >= 1.0 else (middle, high)
        lengths[i] = float(elementary.pow(np.array([10.0]), np.array([high]))[0])
    return lengths
