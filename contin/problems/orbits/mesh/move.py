"""Samples of a family of orbits taken to another mesh and another metric."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Sample
from contin.problems.orbits.mesh.layout import Profile, Transfer, make_scale

if TYPE_CHECKING:
    from contin.problems.orbits.mesh.adaptive_problem import Meshed


class Move:
    """Takes samples to another mesh (by interpolation: the next march corrects its origin) and another metric."""

    def __init__(self, problem: Meshed, old_scale: Array, scale: Array, h: Array) -> None:
        self.problem, self.old_scale, self.scale, self.h = problem, old_scale, scale, h
        self._transfers: dict[bytes, Transfer] = {}  # by the mesh from which they lead: mostly one

    def __call__(self, sample: Sample) -> Sample:
        profile, n = self.problem.profile(sample.z), self.problem.n
        raw = sample.tangent * self._metric(sample, profile)
        values = np.hstack([profile.u, raw[: profile.u.size].reshape(-1, n)])
        if not np.array_equal(profile.h, self.h):
            values = self._transfer(profile)(values)
        moved = replace(profile, u=values[:, :n], h=self.h)
        still = np.zeros(len(self.h))
        t = np.concatenate([values[:, n:].ravel(), raw[profile.u.size : profile.u.size + 1], still, raw[-1:]])
        t /= self.scale
        return replace(sample, z=moved.vector(), tangent=t / np.linalg.norm(t))

    def _metric(self, sample: Sample, profile: Profile) -> Array:
        """The present metric on a sample's own mesh."""
        if sample.z.size == self.old_scale.size:
            return self.old_scale
        return make_scale(profile.h, profile.m, np.ones(profile.n), 1.0, 1.0)

    def _transfer(self, profile: Profile) -> Transfer:
        key = profile.h.tobytes()
        if key not in self._transfers:
            self._transfers[key] = Transfer.to_mesh(profile.m, profile.h, self.h)
        return self._transfers[key]
