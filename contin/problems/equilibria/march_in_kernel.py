"""The march along equilibria, and points of their branch beside it, as kernels carry them out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.metric import far_from_zero
from contin.continuation.sample import STOPS, Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.kernels import algebraic as kernel
from contin.machine import elementary
from contin.problems.equilibria.kernel_memory import memory_of

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

_NO_TANGENT: Final = np.empty(0)
NO_GROWTH: Final = -1.0  # in place of an angle's period: a state whose size does not matter
TURN: Final = 0.01  # scaled: see `trust`


def complex_of(re: Array, im: Array) -> NDArray[np.complex128]:
    """re + i im, without arrays in between."""
    values = np.empty(re.shape, complex)
    values.real, values.imag = re, im
    return values


def trust(problem: AlgebraicEquations) -> float:
    """See `kernels.algebraic.correct`."""
    return 0.0 if problem.system.n_switches else TURN


def march(
    problem: AlgebraicEquations, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float,
    limit: int, bounds: tuple[float, float], settings: Settings, loop: Sample | None,
) -> Chunk:  # fmt: skip
    """See `contin.continuation.problem.Problem.march`."""
    n = problem.n
    rows = limit + 1
    z, t, tests = np.empty((rows, n + 1)), np.empty((rows, n + 1)), np.empty((rows, kernel.TESTS))
    unstable = np.zeros(rows, np.int64)
    re, im, lengths, info = np.empty((rows, n)), np.empty((rows, n)), np.zeros(rows), np.zeros(6)
    z[0], t[0] = origin.z, origin.tangent
    controls = np.array([
        step, settings.min_step, settings.max_step, elementary.cos(np.radians(settings.max_angle)),
        settings.newton_tolerance,
        length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5, trust(problem),
        float(problem.is_timeless),
    ])  # fmt: skip
    reason = kernel.march(
        problem.system.jacobian_address, problem.is_map, problem.base.copy(), problem.active, frame.scale,
        np.array(bounds, dtype=float), controls, limit,
        origin.tangent if before is None else before.tangent,
        np.zeros(kernel.TESTS) if before is None else before.tests,
        _NO_TANGENT if loop is None else loop.z, _NO_TANGENT if loop is None else loop.tangent,
        np.where(far_from_zero(origin.z, frame.scale, problem.angle_periods), NO_GROWTH, problem.angle_periods),
        z, t, tests, unstable, re, im, lengths, info, *memory_of(n, len(problem.base)),
    )  # fmt: skip
    stop = STOPS[reason]
    m = int(info[0]) + 1
    detail = ""
    if stop is Stop.NOT_FINITE:
        nearby = z[m - 1] + frame.scale * info[1] * t[m - 1]
        detail = problem.system.why_not_finite(nearby[:n], problem.full_parameters(nearby)) or ""
    return Chunk(
        z[:m], t[:m], tests[:m], unstable[:m], complex_of(re[:m], im[:m]), lengths[:m], stop,
        float(info[1]), float(info[3]), int(info[4]), int(info[2]), detail,
    )  # fmt: skip


def points_between(
    problem: AlgebraicEquations, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float],
    fractions: Sequence[float], frame: Frame, settings: Settings,
) -> Sequence[Sample | None]:  # fmt: skip
    """See `contin.continuation.problem.Problem.points_between`."""
    z, t, tests, counts, re, im = _between(problem, base, ends, lengths, fractions, frame, settings)
    rows = zip(z, t, tests, counts, complex_of(re, im), strict=True)
    return [None if row[3] < 0 else Sample(*row) for row in rows]


def tests_between(
    problem: AlgebraicEquations, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float],
    fractions: Sequence[float], frame: Frame, settings: Settings,
) -> tuple[Array, Sequence[int]]:  # fmt: skip
    """See `contin.continuation.problem.Problem.tests_between`."""
    _, _, tests, counts, _, _ = _between(problem, base, ends, lengths, fractions, frame, settings)
    return tests, counts


def _between(
    problem: AlgebraicEquations, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float],
    fractions: Sequence[float], frame: Frame, settings: Settings,
) -> tuple[Array, Array, Array, list[int], Array, Array]:  # fmt: skip
    """z, tangents, tests, counts (-1 where there is no point), real and imaginary parts of the eigenvalues."""
    (a, b), count, n = ends, len(fractions), problem.n
    z, t, tests = np.empty((count, n + 1)), np.empty((count, n + 1)), np.empty((count, kernel.TESTS))
    re, im, counts = np.empty((count, n)), np.empty((count, n)), np.empty(count, np.int64)
    kernel.points_between(
        problem.system.jacobian_address, problem.is_map, base.z, base.tangent, a.z, a.tangent, b.z, b.tangent,
        np.array(fractions), np.array([*lengths, *fractions]), problem.base.copy(), problem.active, frame.scale,
        min(settings.tolerance, 1e-9), trust(problem), frame.reference, z, t, tests, re, im, counts,
        *memory_of(n, len(problem.base)),
    )  # fmt: skip
    return z, t, tests, counts.tolist(), re, im


def probes(
    problem: AlgebraicEquations, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
) -> Sequence[Sample | None]:
    """Points at several lengths from `base`, from the rows of `guesses`, in one kernel call."""
    shape = len(lengths), problem.n
    z, t, tests = guesses, np.empty(guesses.shape), np.empty((shape[0], kernel.TESTS))
    re, im, counts = np.empty(shape), np.empty(shape), np.empty(shape[0], np.int64)
    kernel.probes(
        problem.system.jacobian_address, problem.is_map, base.z, base.tangent, lengths, problem.base.copy(),
        problem.active, frame.scale, min(settings.tolerance, 1e-9), trust(problem), frame.reference, z, t, tests, re,
        im, counts,
        *memory_of(problem.n, len(problem.base)),
    )  # fmt: skip
    rows = zip(z, t, tests, counts.tolist(), complex_of(re, im), strict=True)
    return [None if row[3] < 0 else Sample(*row) for row in rows]
