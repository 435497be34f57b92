"""Curves of special solutions of boundary-value problems, whose unknowns follow a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import norm
from contin.loci.augmented.on_meshes import CurveOnMeshes
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.orbits.mesh.move import Move
from contin.problems.orbits.renewal import refitted


@dataclass(frozen=True, eq=False)
class AdaptiveCurve(CurveOnMeshes):
    """`base` has a mesh in its unknowns (`contin.loci.augmented.boundary`)."""

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        base, inner = self.base, self.base.inner(frame.scale)
        problem, profile = base.at(origin.z), base.profile(origin.z)
        sizes, period = problem.sizes(base.inner(origin.z), inner), float(inner[profile.u.size])
        fit = refitted(problem, profile, sizes, period, base.null_functions(origin.z))
        if fit is None:
            return Renewal(frame.scale, origin, before, loop)
        own = make_scale(fit.h, profile.m, fit.sizes, fit.period, float(inner[-1]))
        scale = base.joined(own, base.rest(frame.scale))

        def moved(sample: Sample | None) -> Sample | None:
            return None if sample is None else self._moved(sample, frame.scale, scale, fit.h)

        return Renewal(scale, self._moved(origin, frame.scale, scale, fit.h), moved(before), moved(loop))

    def _moved(self, sample: Sample, old: Array, scale: Array, h: Array) -> Sample:
        base = self.base
        move = Move(base.problem, base.inner(old), base.inner(scale), h)
        bare = replace(sample, z=base.inner(sample.z), tangent=base.inner(sample.tangent))
        share = norm(bare.tangent)
        still = np.full(bare.z.size, 1.0 / np.sqrt(bare.z.size))  # where only further parameters vary
        there = move(replace(bare, tangent=bare.tangent / share if share > 0.0 else still))
        t = base.joined(share * there.tangent, base.rest(sample.tangent))
        return replace(sample, z=base.joined(there.z, base.rest(sample.z)), tangent=t / norm(t))

    def finer(self, near: Sample, frame: Frame) -> tuple[Sample, Frame]:
        """A sample and its metric where every interval is halved."""
        base, inner = self.base, self.base.inner(frame.scale)
        profile = base.profile(near.z)
        h = np.repeat(0.5 * profile.h, 2)
        sizes = base.problem.sizes(base.inner(near.z), inner)
        scale = base.joined(
            make_scale(h, profile.m, sizes, float(inner[profile.u.size]), float(inner[-1])), base.rest(frame.scale)
        )
        return self._moved(near, frame.scale, scale, h), Frame(scale)

    def end_at(self, point: Verified) -> End | None:
        if not point.vectors.get("mirrored"):
            return None
        at = float(point.z[-1])
        text = f"met its own mirror image on the curve of branch points at {self.parameters[0]} = {at:.10g}"
        return End("joined", text, {"at": at})
