"""A point of a curve on a mesh of half the lengths: what the mesh has made of it is the difference."""

from __future__ import annotations

from typing import Final, Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.orbits.mesh.adaptive_problem import Meshed
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.orbits.mesh.move import Move

SETTINGS: Final = Settings()


class Followed(Meshed, Protocol):
    """A problem on a mesh whose points can be solved for."""

    def sizes(self, z: Array, scale: Array) -> Array:
        """Of the functions, in this metric."""

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem.probe`."""


def on_half_lengths(
    problem: Followed, sample: Sample, frame: Frame, finer: Array | None = None
) -> tuple[Sample, Frame] | None:
    """The point next to a sample on the hyperplane normal to its tangent, and the metric there; None: not found.

    finer : another mesh than the one with intervals of half the length.
    """
    profile = problem.profile(sample.z)
    h = np.repeat(0.5 * profile.h, 2) if finer is None else finer
    period = float(frame.scale[profile.u.size])
    scale = make_scale(h, profile.m, problem.sizes(sample.z, frame.scale), period, float(frame.scale[-1]))
    base, there = Move(problem, frame.scale, scale, h)(sample), Frame(scale, frame.reference)
    found = problem.probe(base, 0.0, base.z.copy(), there, SETTINGS)
    return None if found is None else (found, there)
