"""Sizes of the states along an orbit that no metric comes with, in any units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.simulate.natural import filled

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

ALIKE: Final = 1e3  # ratio of sizes up to which the largest number of a column is a good pivot


def state_sizes(problem: OrbitEquations, z: Array) -> Array:
    """(n,): the largest moduli along the orbit z; of states that are next to zero what couples them to the others.

    All 1 where they are alike.
    """
    largest = np.abs(problem.profile(z).u).max(axis=0)
    if np.all(np.isfinite(largest)) and largest.max() > ALIKE * largest.min():
        slopes = np.abs(OrbitLinear(problem, z, np.ones_like(z), z).state_derivatives).mean(axis=(0, 1))
        if np.all(np.isfinite(slopes)):
            return filled(largest, slopes)[0]
    return np.ones(problem.n)
