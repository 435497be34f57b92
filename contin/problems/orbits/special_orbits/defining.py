"""Defining systems of special orbits, solved by Newton to full precision: that of `contin.kernels.special_orbits`.

LPC   the derivative of the boundary-value problem by (u, T) is singular
BPC   the derivative by (u, T, p) has rank one less than at other orbits (two null vectors)
PD    the variational equation has a solution with v(1) = -v(0)
NS    ... with v(2) - 2 cos(theta) v(1) + v(0) = 0, theta unknown
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.orbits.linearised.bordered import Bordered
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.linearised.solved_orbit import SolvedOrbit
from contin.problems.orbits.march.in_kernel import corrected
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.problems.orbits.special_orbits.held_parameter import HeldCurve

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

LEFT: Final = 4.0  # of the next step, all of it rounding but at several multipliers 1, where steps halve the error
NEWTON: Final = Rules(settled=1e-13, stalled=1e-7, far=1e2, budget=48)  # at two multipliers 1 each halves the error
PERTURBATION: Final = 1e-10
SAMPLES: Final = 2
SCATTERED: Final = 4.0  # the error beside the largest of so few samples of rounding
SAME_PERIOD: Final = 1e-3  # relative difference of periods up to which points on two meshes are the same
SAFETY: Final = 2.0  # the finer mesh has an error of its own
UNRESOLVED: Final = 0.2  # distance from 1 of the multiplier on a finer mesh at which a fold by multipliers is none
FAR_LESS: Final = 0.1
UNFOLDED: Final = 1e-6  # unfolding parameter (scaled) that a branch point leaves


def solve_special(
    problem: OrbitEquations, type_: str, z: Array, scale: Array, theta: float = 0.0
) -> SolvedOrbit | None:
    """Newton on the defining system of LPC, BPC, PD or NS from z; None where it does not converge.

    The error has two parts: how rounding reaches p (scatter of Newton steps from perturbed solutions), and the
    discretisation (the same system on a mesh of half the lengths). Cost: about as much as 30 steps of the family.
    """
    found = _newton(problem, type_, z, scale, theta)
    if found is None:
        return None
    profile = problem.profile(found.z)
    refined = special_on_finer_mesh(problem, type_, found.z, scale, found.theta)
    if refined is None:
        finer, finer_scale = on_finer_mesh(problem, found.z, scale)
        interpolated = replace(found, z=finer.vector(), scale=finer_scale)
        error = found.error + float(scale[-1]) * problem.tolerance
        return replace(found, error=error, finer=interpolated, confirmed=False)
    discretisation = SAFETY * abs(refined.z[-1] - found.z[-1])
    period = problem.profile(refined.z).period
    confirmed = abs(period - profile.period) < SAME_PERIOD * profile.period
    return replace(found, error=found.error + discretisation, finer=refined, confirmed=confirmed)


def flat_fold(problem: OrbitEquations, z: Array, scale: Array) -> SolvedOrbit | None:
    """A fold where the parameter is constant to rounding (a canard explosion), z where the multiplier passes 1.

    The defining system is singular to rounding there. The error is the change of the parameter on a mesh of half the
    lengths, at the same period; None where the multiplier there is not near 1, so that it is not resolved.
    """
    linear = OrbitLinear(problem, z, scale, z)
    right, _, _ = Bordered.of(linear.jacobian[:, :-1], 1).solve()
    found = same_period_on_finer_mesh(problem, z, scale)
    if found is None:
        return None
    multipliers = problem.multipliers(found)[1:]
    if not float(np.min(np.abs(multipliers - 1.0))) < UNRESOLVED:
        return None
    residual = float(np.max(np.abs(linear.residual)))
    error = SAFETY * abs(float(found[-1] - z[-1]))
    refined = SolvedOrbit(found, 0.0, residual, error, right, on_finer_mesh(problem, z, scale)[1])
    return SolvedOrbit(z, 0.0, residual, error, right, scale, refined)


def is_told_by_equations(problem: OrbitEquations, fold: SolvedOrbit, near: Array) -> bool:
    """Whether a fold's equations place it better than its multiplier does, z where that passes 1 (`flat_fold`).

    They do where their own period moves far less on a mesh of half the lengths than the two are apart.
    """
    if fold.finer is None or not fold.confirmed:
        return False
    period = problem.profile(fold.z).period
    moved, apart = problem.profile(fold.finer.z).period - period, problem.profile(near).period - period
    return abs(moved) < FAR_LESS * abs(apart)


def on_finer_mesh(problem: OrbitEquations, z: Array, scale: Array) -> tuple[Profile, Array]:
    """The orbit interpolated on a mesh of half the lengths, and the metric there."""
    profile = problem.profile(z)
    finer = profile.on_mesh(np.repeat(profile.h / 2.0, 2))
    period = float(scale[profile.u.size])
    return finer, make_scale(finer.h, profile.m, problem.sizes(z, scale), period, float(scale[-1]))


def special_on_finer_mesh(
    problem: OrbitEquations, type_: str, z: Array, scale: Array, theta: float = 0.0
) -> SolvedOrbit | None:
    """The special orbit on a mesh of half the lengths."""
    finer, finer_scale = on_finer_mesh(problem, z, scale)
    return _newton(problem, type_, finer.vector(), finer_scale, theta, samples=0)


def same_period_on_finer_mesh(problem: OrbitEquations, z: Array, scale: Array) -> Array | None:
    """The orbit of the same period on a mesh of half the lengths."""
    finer, finer_scale = on_finer_mesh(problem, z, scale)
    fixed = np.zeros(finer_scale.size)
    fixed[finer.u.size] = 1.0
    guess = Sample(finer.vector(), fixed, np.zeros(4), 0, np.empty(0, complex))
    found: Array | None = corrected(problem, guess, Frame(finer_scale), 1e-7)
    return found


def _newton(
    problem: OrbitEquations, type_: str, z: Array, scale: Array, theta: float, samples: int = SAMPLES
) -> SolvedOrbit | None:
    curve = HeldCurve.of(type_, problem)
    metric = curve.join(scale, float(scale[-1]), 1.0)
    start = curve.join(z, float(z[-1]), float(elementary.cos(theta)) if type_ == "NS" else 0.0)
    curve = curve.settled(start, metric)

    def correct(x: Array) -> tuple[float, Array] | None:
        found = curve.step(x, metric)
        return None if found is None else (norm(found.step[:-1]), x + metric * found.step)

    found = newton(correct, start, NEWTON)
    return None if found is None or found.exhausted else _measured(problem, curve, found.at, scale, metric, samples)


def _measured(
    problem: OrbitEquations, curve: HeldCurve, x: Array, scale: Array, metric: Array, samples: int
) -> SolvedOrbit | None:
    """What Newton has found at x."""
    z = curve.orbit(x)
    found = curve.step(x, metric)
    if found is None or (curve.type == "BPC" and abs(curve.further(x)) > UNFOLDED):
        return None
    if curve.type == "NS" and not abs(curve.further(x)) < 1.0:  # the product of two real multipliers is 1
        return None
    right = curve.null_vectors(found, x, metric)
    residual = max(found.off, float(np.max(np.abs(OrbitLinear(problem, z, scale, z).residual))))
    moving = np.append(np.arange(curve.nodes(x) + 1), np.arange(x.size - 2 - curve.extra, x.size - 1))
    generator = np.random.default_rng(12345)
    scatter = 0.0
    for _ in range(samples):
        shift = np.zeros(x.size)
        shift[moving] = PERTURBATION * generator.uniform(-1.0, 1.0, moving.size) / np.sqrt(moving.size)
        shift[-1] = shift[-2]
        back = curve.step(x + metric * shift, metric)
        scatter = max(scatter, np.inf if back is None else abs(float(shift[-1] + back.step[-1])))
    error = SCATTERED * scatter + LEFT * abs(float(found.step[-1]))
    return SolvedOrbit(z, curve.theta(x), residual, error * float(scale[-1]), right, scale)
