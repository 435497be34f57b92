"""An orbit on a mesh of half the lengths, which tells what the mesh's own error does to the parameter."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Frame, Sample
from contin.problems.orbits.march.in_kernel import corrected
from contin.problems.orbits.mesh.layout import Profile, make_scale

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

TOLERANCE: Final = 1e-7  # of Newton's last step


def on_finer_mesh(problem: OrbitEquations, z: Array, scale: Array) -> tuple[Profile, Array]:
    """The orbit interpolated on a mesh of half the lengths, and the metric there."""
    profile = problem.profile(z)
    finer = profile.on_mesh(np.repeat(profile.h / 2.0, 2))
    period = float(scale[profile.u.size])
    return finer, make_scale(finer.h, profile.m, problem.sizes(z, scale), period, float(scale[-1]))


def same_period_on_finer_mesh(
    problem: OrbitEquations, z: Array, scale: Array, tolerance: float = TOLERANCE
) -> tuple[Sample, Array] | None:
    """The orbit of the same period on a mesh of half the lengths, and the metric there; None where Newton fails.

    Its tangent is the direction of the period, by which the parameter was solved for.
    """
    finer, finer_scale = on_finer_mesh(problem, z, scale)
    fixed = np.zeros(finer_scale.size)
    fixed[finer.u.size] = 1.0
    guess = Sample(finer.vector(), fixed, np.zeros(4), 0, np.empty(0, complex))
    found: Array | None = corrected(problem, guess, Frame(finer_scale), tolerance)
    return None if found is None else (replace(guess, z=found), finer_scale)
