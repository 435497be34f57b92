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
from contin.kernels.collocation_basis import basis
from contin.kernels.tests_of_stability import map_tests
from contin.machine import elementary
from contin.problems.orbits.linearised.independent_parts import LARGEST, Multipliers, by_parts
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.layout import in_intervals

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

LOST = 1e-3  # distance of the trivial multiplier from 1 from which the other ones are computed anew
EXPLODING = 1e-4  # ... and |dp/ds| (scaled) below which they always are: orbits explode at nearly one parameter
CLEARLY = 1e-6  # way in a period, relative to the states' moduli, of an orbit that is not at rest to rounding


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


def resolve(problem: OrbitEquations, z: Array, re: Array, im: Array, tests: Array | None = None) -> dict[int, int]:
    """Mend in place the multipliers re + i im (R, n) of orbits z (R, size), and their tests for NS and PD (R, 4).

    Returns the unstable counts of the rows that changed: those whose multipliers are not fine (all, without tests) and
    whose equations have parts.
    """
    if not problem.autonomous or problem.n < 2:
        return {}
    wanted = np.arange(len(z)) if tests is None else np.flatnonzero(unresolved(problem, re, im, tests))
    planar = _in_the_plane(problem, z[wanted]) if problem.n == 2 and wanted.size else np.full(wanted.size, np.nan)
    counts = {}
    for row, value in zip(wanted.tolist(), planar.tolist(), strict=True):
        values = np.array([value], complex) if value == value else _by_parts(problem, z[row])
        if values is None:
            continue
        re[row, 0], im[row, 0] = 1.0, 0.0
        re[row, 1:], im[row, 1:] = values.real, values.imag
        signs = np.empty(4)
        counts[row] = int(map_tests(re[row, 1:].copy(), im[row, 1:].copy(), signs))
        if tests is not None:
            tests[row, 2:] = signs[2:]
    return counts


def _by_parts(problem: OrbitEquations, z: Array) -> Multipliers | None:
    return by_parts(OrbitLinear(problem, z, np.ones_like(z), z))


def _in_the_plane(problem: OrbitEquations, z: Array) -> Array:
    """What `by_parts` finds for orbits z (R, size) whose two states drive each other, all at once; else NaN."""
    first = problem.profile(z[0])
    place, m, count = first.u.size, first.m, first.intervals
    u, period, h = z[:, :place].reshape(len(z), -1, 2), z[:, place], z[:, place + 1 : place + 1 + count]
    inside = in_intervals(basis(m).values, u.transpose(1, 0, 2).reshape(-1, 2 * len(z)))
    states = inside.reshape(-1, len(z), 2).transpose(1, 0, 2).reshape(-1, 2)
    parameters = np.tile(problem.full_parameters(z[0]), (len(z), 1))
    parameters[:, problem.active] = z[:, -1]
    field, jacobians = problem.system.jacobians(states, np.repeat(parameters, count * m, axis=0))
    field, jacobians = field.reshape(len(z), -1, 2), jacobians.reshape(len(z), count, m, 2, -1)
    drive = (jacobians[..., [0, 1], [1, 0]] != 0.0).any(axis=(1, 2)).all(axis=1)
    moving = period[:, None] * np.abs(field).max(axis=1) > CLEARLY * np.abs(u).max(axis=1)
    divergence = jacobians[..., 0, 0] + jacobians[..., 1, 1]
    growth = period * np.einsum("ri,rim,m->r", h, divergence, basis(m).gauss_weights)
    found = elementary.exp(np.clip(growth, -LARGEST, LARGEST))
    return np.where(drive & moving.any(axis=1), found, np.nan)
