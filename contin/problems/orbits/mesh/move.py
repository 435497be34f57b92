"""Samples of a family of orbits taken to another mesh and another metric."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Sample
from contin.problems.orbits.mesh.layout import Profile, Transfer, make_scale

if TYPE_CHECKING:
    from contin.problems.orbits.mesh.adaptive_problem import Meshed


class Move:
    """Takes samples to another mesh (by interpolation: the next march corrects its origin) and another metric."""

    def __init__(self, problem: Meshed, old_scale: Array, scale: Array, h: Array) -> None:
        self.problem, self.old_scale, self.scale, self.h = problem, old_scale, scale, h

    def __call__(self, sample: Sample) -> Sample:
        return self.together([sample])[0]

    def each(self, *samples: Sample | None) -> list[Sample | None]:
        """The samples there, and None for None."""
        moved = iter(self.together([sample for sample in samples if sample is not None]))
        return [None if sample is None else next(moved) for sample in samples]

    def together(self, samples: Sequence[Sample]) -> list[Sample]:
        """The samples there; those of one mesh are interpolated at once."""
        n, moved = self.problem.n, list(samples)
        profiles = [self.problem.profile(sample.z) for sample in samples]
        raw = [s.tangent * self._metric(s, profile) for s, profile in zip(samples, profiles, strict=True)]
        meshes = [profile.h.tobytes() for profile in profiles]
        for mesh in dict.fromkeys(meshes):
            places = [k for k, other in enumerate(meshes) if other == mesh]
            pairs = [(profiles[k].u, raw[k][: profiles[k].u.size].reshape(-1, n)) for k in places]
            values = np.hstack([part for pair in pairs for part in pair])
            if mesh != self.h.tobytes():
                values = Transfer.to_mesh(profiles[places[0]].m, profiles[places[0]].h, self.h)(values)
            for k, (u, t) in zip(places, _in_pairs(values, n), strict=True):
                moved[k] = self._there(samples[k], profiles[k], u, t, raw[k])
        return moved

    def _there(self, sample: Sample, profile: Profile, u: Array, t: Array, raw: Array) -> Sample:
        """The sample with these values and derivatives at the nodes; raw : its tangent, in no metric."""
        size = self.scale.size
        z, tangent = np.empty(size), np.zeros(size)
        z[: u.size], z[u.size], z[u.size + 1 : -1], z[-1] = u.ravel(), profile.period, self.h, profile.parameter
        tangent[: u.size], tangent[u.size], tangent[-1] = t.ravel(), raw[profile.u.size], raw[-1]
        tangent /= self.scale
        return replace(sample, z=z, tangent=tangent / np.linalg.norm(tangent))

    def _metric(self, sample: Sample, profile: Profile) -> Array:
        """The present metric on a sample's own mesh."""
        if sample.z.size == self.old_scale.size:
            return self.old_scale
        return make_scale(profile.h, profile.m, np.ones(profile.n), 1.0, 1.0)


def _in_pairs(values: Array, n: int) -> list[tuple[Array, Array]]:
    """Columns n by n, the first n and the second n, and so on."""
    parts = [values[:, k : k + n] for k in range(0, values.shape[1], n)]
    return list(zip(parts[0::2], parts[1::2], strict=True))
