"""The compiled march of a family of orbits: its numbers in and out, and what is computed anew of its last rows.

One kernel (`contin.kernels.collocation_march.follow`) marches, corrects, measures and computes multipliers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.sample import STOPS, Chunk, Frame, Sample, Stop, opposite
from contin.continuation.settings import Settings
from contin.kernels import collocation_march as kernel
from contin.kernels.collocation_basis import basis
from contin.kernels.collocation_march import CORRECT, MARCH, PROBE, STABILITY
from contin.machine import elementary
from contin.problems.orbits.linearised.resolved_multipliers import resolve
from contin.problems.orbits.march.memory import memory_of
from contin.problems.orbits.march.rows import Rows
from contin.problems.orbits.march.slow_passage import dwelling
from contin.problems.orbits.mesh.adaption import WORTHWHILE, estimate
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.problems.tolerances import PROBE_TOLERANCE

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

CONTROLS: Final = 10  # numbers that steer the kernel
TESTS: Final = 4  # ... and test functions that it fills
ALIGNED: Final = 0.99  # cosine of two tangents at one point, up to rounding
LONGEST_CHUNK: Final = 300
DWELLING: Final = 0.2  # part of the period spent slowly from which growing periods are watched closely


def march(
    family: OrbitEquations, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
    bounds: tuple[float, float], settings: Settings, loop: Sample | None,
) -> Chunk:  # fmt: skip
    """A chunk of the family from `origin`, see `contin.continuation.problem.Problem.march`."""
    profile = family.profile(origin.z)
    limit = min(limit, _chunk(profile))
    out = Rows.of(limit + 1, origin.z.size, TESTS, family.n)
    out.z[0], out.t[0] = origin.z, origin.tangent
    controls = np.array([
        step, settings.min_step, settings.max_step, elementary.cos(np.radians(settings.max_angle)),
        settings.newton_tolerance,
        length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5,
        _error_limit(family, profile, frame.scale), _period_limit(family, profile, frame.scale),
        0.0 if family.intervals is None else WORTHWHILE,
    ])  # fmt: skip
    reason = _call(family, MARCH, out, frame.scale, controls, limit, bounds, before, loop)
    z, t, info = out.z, out.t, out.info
    stop, m = STOPS[reason], len(out)
    if stop in (Stop.EVENT, Stop.DIP):
        measured = Frame(frame.scale, float(info[3]))
        for row in range(max(m - 2, 0), m):
            _measure(family, out, row, measured)
        m, stop = _up_to_first_event(family, out, m, stop, measured)
    if _resolve(family, out, slice(0, m)):
        changed = np.flatnonzero(np.diff(out.unstable[:m]))
        if changed.size:  # the march may have counted otherwise: what happens in its last step is looked at
            m, stop = (int(changed[0]) + 2, Stop.EVENT) if changed[0] + 2 < m or stop is Stop.LIMIT else (m, stop)
    detail = ""
    if stop is Stop.NOT_FINITE:
        detail = family.explain_states(z[m - 1] + frame.scale * info[1] * t[m - 1]) or ""
    info[0] = m - 1
    return out.chunk(stop, float(info[3]), int(info[4]), detail)


def probe(
    family: OrbitEquations, z0: Array, tangent: Array, length: float, guess: Array, frame: Frame, tolerance: float
) -> Sample | None:
    """The orbit with <tangent, (z - z0) / scale> = length next to a guess, measured; None where Newton fails."""
    out = Rows.of(2, z0.size, TESTS, family.n)
    out.z[0], out.t[0], out.z[1] = z0, tangent, guess
    out.info[3] = frame.reference
    count = _call(family, PROBE, out, frame.scale, _tolerance(tolerance, length))
    if count < 0:
        return None
    out.unstable[1] = count
    _resolve(family, out, slice(1, 2))
    return Sample(out.z[1], out.t[1], out.tests[1], int(out.unstable[1]), out.re[1] + 1j * out.im[1])


def corrected(family: OrbitEquations, sample: Sample, frame: Frame, tolerance: float) -> Array | None:
    """The orbit on the hyperplane through the sample, normal to its tangent; no measuring."""
    out = Rows.of(2, sample.z.size, TESTS, family.n)
    out.z[0], out.t[0], out.z[1] = sample.z, sample.tangent, sample.z
    return out.z[1] if _call(family, CORRECT, out, frame.scale, _tolerance(tolerance)) == 0 else None


def multipliers(family: OrbitEquations, z: Array) -> NDArray[np.complex128]:
    """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""
    out = Rows.of(1, z.size, TESTS, family.n)
    out.z[0], out.t[0] = z, 0.0
    profile = family.profile(z)
    scale = make_scale(profile.h, profile.m, family.state_sizes(profile), profile.period, 1.0)
    _call(family, STABILITY, out, scale, np.zeros(CONTROLS))
    resolve(family, out.z, out.re, out.im)
    return np.asarray(out.re[0] + 1j * out.im[0])


def _tolerance(tolerance: float, length: float = 0.0) -> Array:
    """Controls of a correction."""
    controls = np.zeros(CONTROLS)
    controls[0], controls[4] = length, tolerance
    return controls


def _call(
    family: OrbitEquations, mode: int, out: Rows, scale: Array, controls: Array, limit: int = 0,
    bounds: tuple[float, float] = (0.0, 0.0), before: Sample | None = None, loop: Sample | None = None,
) -> int:  # fmt: skip

    scheme, n = basis(family.points), family.n
    none, size = np.empty(0), out.z.shape[1]
    intervals = (size - n - 2) // (family.points * n + 1)
    free = n - 1 if family.autonomous else n
    points, factors, scratch = memory_of(n, family.points, free, intervals, size, family.full_parameters(out.z[0]))
    return int(kernel.follow(
        mode, family.equations, points, factors, scratch, scale, family.sizes(out.z[0], scale),
        np.array(bounds, dtype=float), controls, limit, scheme.top, scheme.error,
        out.z[0] if before is None else before.z, out.t[0].copy() if before is None else before.tangent,
        np.zeros(TESTS) if before is None else before.tests,
        none if loop is None else loop.z, none if loop is None else loop.tangent,
        out.z, out.t, out.tests, out.unstable, out.re, out.im, out.lengths, np.zeros(len(out.z)), out.info,
    ))  # fmt: skip


def _up_to_first_event(family: OrbitEquations, out: Rows, m: int, stop: Stop, frame: Frame) -> tuple[int, Stop]:
    """Rows up to the first change: the row before the last one, measured exactly, may lie beyond it already."""
    while m > 2 and _differ(out, m - 3, m - 2):
        _measure(family, out, m - 3, frame)
        if not _differ(out, m - 3, m - 2):
            break
        m, stop = m - 1, Stop.EVENT
    return m, stop


def _differ(out: Rows, one: int, other: int) -> bool:
    return bool(out.unstable[one] != out.unstable[other] or np.any(opposite(out.tests[one], out.tests[other])))


def _measure(family: OrbitEquations, out: Rows, row: int, frame: Frame) -> None:
    """Tests and multipliers of a row anew: the march takes them from factors of a point nearby."""
    exact = probe(family, out.z[row], out.t[row], 0.0, out.z[row], frame, PROBE_TOLERANCE)
    if exact is not None and float(exact.tangent @ out.t[row]) > ALIGNED:
        out.tests[row], out.unstable[row] = exact.tests, exact.unstable
        out.re[row], out.im[row] = exact.eigenvalues.real, exact.eigenvalues.imag


def _resolve(family: OrbitEquations, out: Rows, rows: slice) -> bool:
    """Multipliers of rows that a product of matrices does not resolve, from the parts of the equations."""
    counts = resolve(family, out.z[rows], out.re[rows], out.im[rows], out.tests[rows])
    for row, count in counts.items():
        out.unstable[rows.start + row] = count
    return bool(counts)


def _chunk(profile: Profile) -> int:
    """Steps in one kernel call, which cannot be interrupted: some 0.2 s."""
    n = profile.n
    step = 1e-6 * profile.intervals * (2.0 + 0.8 * n + 0.007 * n**3)  # seconds
    return int(np.clip(0.2 / step, 10, LONGEST_CHUNK))


def _error_limit(family: OrbitEquations, profile: Profile, scale: Array) -> float:
    """The error of the mesh at which a march returns."""
    error, _ = estimate(profile, family.sizes(profile.vector(), scale))
    return max(family.tolerance, (3.0 if family.intervals is None else 30.0) * error)


def _period_limit(family: OrbitEquations, profile: Profile, scale: Array) -> float:
    """The period at which a march returns: soon, where the orbit already lingers somewhere."""
    limit = 2.0 * float(scale[profile.u.size])
    if family.autonomous and dwelling(family, profile, family.sizes(profile.vector(), scale)) > DWELLING:
        limit = min(limit, 1.1 * profile.period)
    return limit
