"""The multiplier of a planar orbit by the formula of Liouville, where the product of matrices does not resolve it.

Along a canard perturbations first grow and then shrink (or the other way round) by hundreds of powers of ten. In the
plane their net growth is exp of an integral, log mu = T int_0^1 div f(u(x)) dx, which loses nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation import evaluate, new_points
from contin.kernels.collocation_basis import basis
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.problems.orbits.problem import OrbitProblem

LOST = 1e-3  # distance of the trivial multiplier from 1 from which the other one is computed anew
EXPLODING = 1e-4  # ... and |dp/ds| (scaled) below which it always is: orbits explode at nearly one parameter
LARGEST = 690.0  # of |log mu|, so that mu is a number


def applies(problem: OrbitProblem) -> bool:
    """True for orbits of autonomous equations in the plane."""
    return bool(problem.autonomous and problem.n == 2)


def unresolved(re: Array, im: Array, tests: Array) -> NDArray[np.bool_]:
    """Which of some orbits, multipliers re + i im (R, 2) and tests (R, 4), need the formula."""
    fine = (np.abs(re[:, 0] - 1.0) < LOST) & (im[:, 0] == 0.0) & (re[:, 1] > 0.0) & (im[:, 1] == 0.0)
    return np.asarray(~(fine & (np.abs(tests[:, 0]) > EXPLODING)))


def resolve(problem: OrbitProblem, z: Array, re: Array, im: Array, tests: Array | None = None) -> int | None:
    """Mend in place the multipliers re + i im (2,) of an orbit, and the signs of its tests for NS and PD.

    Returns the unstable count; None, and nothing changes, where the multipliers are fine or the orbit is not planar.
    """
    if not applies(problem):
        return None
    if tests is not None and not unresolved(re[None], im[None], tests[None])[0]:
        return None
    mu = multiplier(problem, z)
    if not np.isfinite(mu):
        return None
    re[:], im[:] = (1.0, mu), 0.0
    if tests is not None:
        tests[2:] = np.abs(tests[2:])
    return int(mu > 1.0)


def multiplier(problem: OrbitProblem, z: Array) -> float:
    """exp(T int div f), by the quadrature of the collocation points."""
    profile = problem.profile(z)
    w = new_points(profile.n, profile.m, profile.intervals, problem.full_parameters(z))  # type: ignore[no-untyped-call]
    evaluate(problem.equations, w, z, True)
    divergence = w.fu[:, 0, 0, :] + w.fu[:, 1, 1, :]  # (m, N)
    growth = profile.period * float(basis(profile.m).gauss_weights @ divergence @ profile.h)
    return float(elementary.exp(np.clip(growth, -LARGEST, LARGEST)))
