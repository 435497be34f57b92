"""The grazing orbit at which a family meets a corner, from the arm on which the surface is not crossed.

There the orbit depends smoothly on arclength, and so does its clearance, the smallest distance |h| from the surface; on
the other arm the time spent beyond the surface changes like a square root.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.shooting.sampling import crossings, states
from contin.problems.shooting.signature import signature

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

SAMPLES: Final = 400
FINER: Final = 33
AWAY: Final = (1e-3, 1e-4, 1e-5)  # (arclength) from the corner, where the secant iteration begins
SHORT_OF: Final = 1e-3  # part of a secant step that is left out: beyond the zero lies the other arm
BUDGET: Final = 12
NEARLY: Final = 1e-6  # clearance, relative to that at the beginning, from which the zero may be extrapolated to
REACHED: Final = 1e-12  # clearance, relative to that at the beginning
BACK: Final = (0.0, 1e-3, 1e-2, 0.1, 0.5)  # parts of the last step that are left out where it ends on the other arm
FAR: Final = 0.05  # (arclength) the corner is not that far from the samples beside it


def grazing(
    problem: ShotEquations, near: Sample, arm: tuple[int, ...], other: tuple[int, ...], frame: Frame
) -> tuple[Array, float] | None:
    """(z, error in arclength) of the orbit that touches a surface, next to a sample of the arm with fewer crossings."""
    missing = sorted({j for j in other if other.count(j) > arm.count(j)})
    for length in AWAY:
        for s in (length, -length):
            base = problem.probe(near, s, near.z + s * _raw(near, frame), frame, Settings())
            if base is None or signature(problem, base.z) != arm:
                continue
            first, second = (clearance(problem, z, missing) for z in (base.z, near.z))
            if np.isfinite(first) and first > second:
                return _secant(problem, base, -np.sign(s), abs(s), missing, arm, frame)
    return None


def _secant(
    problem: ShotEquations, base: Sample, sense: float, length: float, missing: list[int], arm: tuple[int, ...],
    frame: Frame
) -> tuple[Array, float] | None:  # fmt: skip
    s0, e0, z0 = 0.0, clearance(problem, base.z, missing), base.z
    s1, beginning, along = 0.5 * length, e0, sense * _raw(base, frame)  # along: the last secant, which predicts
    slope = np.nan
    for _ in range(BUDGET):
        found = problem.probe(base, sense * s1, z0 + (s1 - s0) * along, frame, Settings())
        if found is None or signature(problem, found.z) != arm:
            if e0 <= NEARLY * beginning:  # Newton's steps cross the surface, and the solution slides along it
                return _on_arm(problem, z0, -e0 / slope * along, arm), -e0 / slope
            s1 = 0.5 * (s0 + s1)
            continue
        e1 = clearance(problem, found.z, missing)
        if not e1 < e0:
            return None
        slope = (e1 - e0) / (s1 - s0)
        rest = -e1 / slope
        if e1 <= REACHED * beginning or rest <= 1e-13:
            last = _on_arm(problem, found.z, (found.z - z0) * (rest / (s1 - s0)), arm)
            return last, rest + 10.0 * problem.accuracy
        if s1 + rest > FAR:
            return None
        along = (found.z - z0) / (s1 - s0)
        s0, e0, z0, s1 = s1, e1, found.z, s1 + rest * (1.0 - SHORT_OF)
    return None


def _on_arm(problem: ShotEquations, z: Array, step: Array, arm: tuple[int, ...]) -> Array:
    """z + step, or a little less where rounding has taken that across the surface: there solutions may slide along it.

    The error that is stated covers the whole step.
    """
    for short in BACK:
        if signature(problem, z + (1.0 - short) * step) == arm:
            return np.asarray(z + (1.0 - short) * step)
    return np.asarray(z + step)


def _raw(sample: Sample, frame: Frame) -> Array:
    return np.where(sample.tangent == 0.0, 0.0, sample.tangent * frame.scale)


def clearance(problem: ShotEquations, z: Array, missing: list[int]) -> float:
    """How close the orbit comes to one of these surfaces without crossing it: the smallest such |h|."""
    times = np.union1d(np.arange(SAMPLES) / SAMPLES, crossings(problem, z))
    best = np.inf
    for j, h in zip(missing, surfaces(problem, z, times).T[missing], strict=True):
        inner = np.abs(h)
        low = (inner <= np.roll(inner, 1)) & (inner <= np.roll(inner, -1))
        low &= (h * np.roll(h, 1) > 0.0) & (h * np.roll(h, -1) > 0.0)
        for place in times[low]:
            fine = (place + np.linspace(-1.0, 1.0, FINER) / SAMPLES) % 1.0
            order = np.argsort(fine)
            values = np.empty(FINER)
            values[order] = np.abs(surface(problem, z, j, fine[order]))
            k = int(np.clip(np.argmin(values), 1, FINER - 2))
            best = min(best, float(values.min()), _bottom(*values[k - 1 : k + 2]) if k != FINER // 2 else np.inf)
    return best


def _bottom(a: float, b: float, c: float) -> float:
    """Smallest value of the parabola through three equally spaced values with the middle one lowest."""
    bend = a - 2.0 * b + c
    return b - 0.125 * elementary.square(a - c) / bend if bend > 0.0 else b


def surface(problem: ShotEquations, z: Array, j: int, times: Array) -> Array:
    """h_j at scaled times."""
    return np.ascontiguousarray(surfaces(problem, z, times)[:, j])


def surfaces(problem: ShotEquations, z: Array, times: Array) -> Array:
    """All h_j at scaled times, (T, count)."""
    pieces, u = problem.system.pieces, states(problem, z, times)
    p = np.zeros((len(times), pieces.p_size))
    p[:, : pieces.first_mode] = problem.full_parameters(z)[: pieces.first_mode]
    if problem.system.is_forced:
        p[:, -1] = times * float(z[-problem.n - 3])
    return pieces.distances(u, p)
