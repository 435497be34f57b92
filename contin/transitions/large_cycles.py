"""The seed of the cycles that are born at a Hopf point of a large system."""

from __future__ import annotations

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits.large_orbit import INTERVALS, PERIOD_SCALE, LargeOrbitProblem
from contin.problems.large_orbits.layout import OnPoints
from contin.problems.large_orbits.radau import STAGES, Trajectory
from contin.problems.orbits.linearised.multipliers import of_rest
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.systems.functions.function_problem import DENSE_IN_KERNELS


def large_cycles(problem: LargeProblem, point: SpecialPoint, parameter: str) -> Seed:
    """Small cycles u + r 2 Re(q exp(2 pi i t)), to first order in r."""
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    _need_entries(problem)
    n, omega, q = problem.n, float(point.vectors["omega"]), np.asarray(point.vectors["q"])
    p = problem.full_parameters(point.z)
    orbits = LargeOrbitProblem(problem.system, p, problem.active, OnPoints(INTERVALS))
    rest = Trajectory(np.tile(point.z[:-1], (INTERVALS, STAGES, 1)), 2.0 * np.pi / omega)
    waves = elementary.exp(2.0j * np.pi * rest.times[1:])
    first = 2.0 * (waves[:, None] * q).real
    z = orbits.vector(rest, float(point.z[-1]))
    size = float(point.scale[0]) / np.sqrt(n) / float(problem.system.model.typical[0])
    scale = orbits.scale_of(size, np.array([PERIOD_SCALE * rest.period, float(point.scale[-1])]))
    direction = np.append(first.ravel(), [0.0, 0.0]) / scale
    return Seed(
        orbits, z, direction / norm(direction), None, scale, (1,), Parent.of(point),
        measured=of_rest(np.asarray(point.eigenvalues), omega, rest.period),
    )  # fmt: skip


def _need_entries(problem: LargeProblem) -> None:
    """InputError: what is missing, where the Jacobian is only applied and too large for a product a column."""
    model = problem.system.model
    if model.method != "sparse" and problem.n > DENSE_IN_KERNELS:
        raise InputError(
            f"function {model.name!r} has {problem.n} states and no entries of its Jacobian: orbits factor its linear "
            f"equations, and beyond {DENSE_IN_KERNELS} states need a sparse `jacobian`, or its `sparsity`"
        )
