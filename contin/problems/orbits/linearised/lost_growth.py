"""Whether orbits that are called stable may be unstable: where perturbations grow by powers of e within one interval.

Beside a repelling slow manifold (a canard, a saddle that is passed along its stable manifold) the orbit is smooth and
its intervals are long. There the collocation equations have, for the growth exp(z) over an interval, its diagonal Pade
approximant of order m, which is 1 for large z. So an orbit with the multiplier exp(100) can come out as stable, with a
trivial multiplier that looks fine.
"""

from __future__ import annotations

from math import factorial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.position import position
from contin.machine import elementary
from contin.problems.algebraic_states import massless
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.layout import trimmed

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

FOLLOWED: Final = 2.0  # growth over an interval that the equations with 4 points have to 1e-4 of its size, or better
TOLD: Final = 1e-3  # growth (of the log of a multiplier) below which nothing is lost
LOOKED: Final = 24  # stable rows that are looked at
ENDLESS: Final = 1e8  # growth beyond which |R| is 1 to rounding


def remark(problem: OrbitEquations, z: Array, multipliers: NDArray[np.complex128]) -> str:
    """A note on rows z (K, N), multipliers (K, n), of which all but the trivial one are below 1 and need not be."""
    first = int(problem.autonomous)
    others = np.abs(multipliers[:, first:])
    if others.shape[1] < 1 + first or massless(problem.system).any():  # in the plane they are integrals
        return ""
    logs = _log(np.max(others, axis=1))
    rows = np.flatnonzero(logs < 0.0)  # NaN: a note of its own
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, min(LOOKED, len(rows))).astype(int))]
    missed = [row for row in rows.tolist() if lost_growth(problem, trimmed(z[row]), 1 + first) > max(-logs[row], TOLD)]
    if not missed:
        return ""
    return (
        f"orbits that are called stable need not be near {position(problem, z[missed[0]])} ({len(missed)} of "
        f"{len(rows)} rows that were looked at): perturbations of them grow by powers of e within one interval of the "
        "mesh (along a canard, or past a saddle), which multipliers do not show; write more `intervals` in `settings`"
    )


def lost_growth(problem: OrbitEquations, z: Array, dimension: int) -> float:
    """log of how much volumes of this dimension grow along the orbit z beyond what the collocation equations have.

    By the eigenvalues of T f_u in the middle of each interval: of an autonomous system the plane of the orbit's
    direction and the leading multiplier's grows with the product of both, so that a direction in which the orbit
    decays past a saddle is counted against the one in which it leaves.
    """
    linear = OrbitLinear(problem, z, np.ones_like(z), z)
    profile = linear.profile
    lengths = profile.period * profile.h
    jacobians = linear.state_derivatives[:, profile.m // 2]
    long = lengths * np.sqrt(np.einsum("ikq,ikq->i", jacobians, jacobians)) > FOLLOWED
    if not long.any() or not np.isfinite(jacobians).all():
        return 0.0
    growth = lengths[long, None] * np.linalg.eigvals(jacobians[long]).real
    leading = np.sort(growth, axis=1)[:, -dimension:]
    return float(np.sum(leading - _as_collocated(leading, profile.m)))


def _as_collocated(growth: Array, m: int) -> Array:
    """log |R(z)| for R = P(z)/P(-z), by which the m-point Gauss method multiplies a solution of v' = z v."""
    powers = np.polynomial.Polynomial(
        [
            factorial(2 * m - k) * factorial(m) / (factorial(2 * m) * factorial(k) * factorial(m - k))
            for k in range(m + 1)
        ]
    )
    z = np.clip(growth, -ENDLESS, ENDLESS)
    return _log(np.abs(powers(z))) - _log(np.abs(powers(-z)))


def _log(sizes: Array) -> Array:
    """log of sizes >= 0, of 0 that of the least number; NaN of NaN."""
    return np.asarray(elementary.log(np.maximum(sizes, np.finfo(float).tiny)))
