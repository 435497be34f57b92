"""The compiled march of a boundary-value problem (`contin.kernels.boundary_march`): its numbers in and out."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_equations import LONGEST_CHUNK, BoundaryEquations
from contin.continuation.sample import STOPS, Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.kernels import boundary_march as kernel
from contin.kernels.collocation_basis import basis
from contin.kernels.collocation_march import MARCH, PROBE
from contin.machine import elementary
from contin.problems.orbits.march.memory import memory_of
from contin.problems.orbits.march.rows import Rows
from contin.problems.orbits.mesh.adaption import WORTHWHILE, estimate

CONTROLS: Final = 9
PROBE_TOLERANCE: Final = 1e-9
UNRESOLVED: Final = 2  # ... on a mesh whose error is `ROUGH` times the tolerance: layers form, or move
ROUGH: Final = 3.0
NO_VALUES: Final = np.zeros(0, complex)


def march(
    problem: BoundaryEquations, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float,
    limit: int, bounds: tuple[float, float], settings: Settings, loop: Sample | None,
) -> Chunk:  # fmt: skip
    """A chunk of the branch from `origin`, see `contin.continuation.problem.Problem.march`."""
    profile = problem.profile(origin.z)
    sizes = problem.sizes(origin.z, frame.scale)
    error, _ = estimate(profile, sizes, closed=False)
    fixed = problem.intervals is not None
    rows = _chunk(profile.n, profile.intervals) if error <= ROUGH * problem.tolerance else UNRESOLVED
    out = Rows.of(min(limit, rows) + 1, origin.z.size, kernel.TESTS, 0)
    out.z[0], out.t[0] = origin.z, origin.tangent
    controls = np.array([
        step, settings.min_step, settings.max_step, elementary.cos(np.radians(settings.max_angle)),
        settings.newton_tolerance, length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5,
        max(problem.tolerance, ROUGH * error), WORTHWHILE if fixed else 0.0,
    ])  # fmt: skip
    reason = _call(problem, MARCH, out, frame.scale, controls, len(out.z) - 1, bounds, before, loop)
    return out.chunk(STOPS[reason], float(out.info[3]), int(out.info[4]))


def probe(
    problem: BoundaryEquations, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings
) -> Sample | None:
    """See `contin.continuation.problem.Problem.probe`."""
    out = Rows.of(2, guess.size, kernel.TESTS, 0)
    out.z[0], out.t[0], out.z[1] = base.z, base.tangent, guess
    out.info[3] = frame.reference
    controls = np.zeros(CONTROLS)
    controls[0], controls[4] = length, min(settings.tolerance, PROBE_TOLERANCE)
    if _call(problem, PROBE, out, frame.scale, controls) < 0:
        return None
    return Sample(out.z[1], out.t[1], out.tests[1], 0, NO_VALUES)


def _call(
    problem: BoundaryEquations, mode: int, out: Rows, scale: Array, controls: Array, limit: int = 0,
    bounds: tuple[float, float] = (0.0, 0.0), before: Sample | None = None, loop: Sample | None = None,
) -> int:  # fmt: skip
    scheme, n, m = basis(problem.points), problem.n, problem.points
    none, size = np.empty(0), out.z.shape[1]
    intervals = (size - n - 2) // (m * n + 1)
    points, factors, scratch = memory_of(n, m, 0, intervals, size, problem.full_parameters(out.z[0]))
    return int(kernel.follow(
        mode, problem.at_ends, problem.equations, points, factors, scratch, scale, problem.sizes(out.z[0], scale),
        np.array(bounds, dtype=float), controls, limit, scheme.top, scheme.error,
        out.z[0].copy() if before is None else before.z, out.t[0].copy() if before is None else before.tangent,
        np.zeros(kernel.TESTS) if before is None else before.tests,
        none if loop is None else loop.z, none if loop is None else loop.tangent,
        out.z, out.t, out.tests, out.lengths, out.info,
    ))  # fmt: skip


def _chunk(n: int, intervals: int) -> int:
    """Steps in one kernel call, which cannot be interrupted: some 0.2 s."""
    step = 1e-6 * intervals * (2.0 + 0.8 * n + 0.007 * n**3)  # seconds
    return int(np.clip(0.2 / step, 10, LONGEST_CHUNK))
