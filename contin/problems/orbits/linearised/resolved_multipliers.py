"""Multipliers of an orbit where the product of matrices does not resolve them, from the parts of the equations.

Along a canard perturbations first grow and then shrink (or the other way round) by hundreds of powers of ten. In the
plane their net growth is exp of an integral, log mu = T int_0^1 div f(u(x)) dx, which loses nothing; a part of two
states in a larger system, that drives the others or is driven by states at rest, has the same formula (`parts`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.tests_of_stability import map_tests
from contin.problems.orbits.linearised.independent_parts import by_parts
from contin.problems.orbits.linearised.linear import OrbitLinear

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

LOST = 1e-3  # distance of the trivial multiplier from 1 from which the other ones are computed anew
EXPLODING = 1e-4  # ... and |dp/ds| (scaled) below which they always are: orbits explode at nearly one parameter


def is_planar(problem: OrbitEquations) -> bool:
    """True for orbits of autonomous equations in the plane."""
    return bool(problem.autonomous and problem.n == 2)


def unresolved(problem: OrbitEquations, re: Array, im: Array, tests: Array) -> NDArray[np.bool_]:
    """Which of some orbits, multipliers re + i im (R, n) and tests (R, 4), need the parts of the equations."""
    if not problem.autonomous or problem.n < 2:
        return np.zeros(len(re), bool)
    fine = (np.abs(re[:, 0] - 1.0) < LOST) & (im[:, 0] == 0.0) & (np.abs(tests[:, 0]) > EXPLODING)
    if problem.n == 2:
        fine &= (re[:, 1] > 0.0) & (im[:, 1] == 0.0)
    return np.asarray(~fine)


def resolve(problem: OrbitEquations, z: Array, re: Array, im: Array, tests: Array | None = None) -> int | None:
    """Mend in place the multipliers re + i im (n,) of an orbit, and its tests for NS and PD.

    Returns the unstable count; None, and nothing changes, where the multipliers are fine or there are no parts.
    """
    if not problem.autonomous or problem.n < 2:
        return None
    if tests is not None and not unresolved(problem, re[None], im[None], tests[None])[0]:
        return None
    values = by_parts(OrbitLinear(problem, z, np.ones_like(z), z))
    if values is None:
        return None
    re[0], im[0] = 1.0, 0.0
    re[1:], im[1:] = values.real, values.imag
    signs = np.empty(4)
    count = int(map_tests(np.ascontiguousarray(values.real), np.ascontiguousarray(values.imag), signs))
    if tests is not None:
        tests[2:] = signs[2:]
    return count
