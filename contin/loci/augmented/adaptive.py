"""Curves whose unknowns follow a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self, cast

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Outcome, Verified, unverified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample, opposite
from contin.continuation.settings import Settings
from contin.linalg.vectors import norm
from contin.loci.augmented import events
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.orbits.mesh.move import Move
from contin.problems.orbits.renewal import refitted
from contin.problems.tolerances import ONE_POINT

SETTINGS: Final = Settings()
ORDER: Final = 1.25  # the finer mesh leaves an error of its own, 2^-2m of this one


@dataclass(frozen=True, eq=False)
class AdaptiveCurve(AugmentedCurve):
    """`base` has a mesh in its unknowns (`contin.loci.augmented.boundary`)."""

    base: Any

    adaptive = True

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

    def refined(self, sample: Sample, frame: Frame) -> tuple[AdaptiveCurve, Sample, Frame] | None:
        """Of a point of the curve that has no defining system (a user value), by which its error is told."""
        near, finer = self.finer(sample, frame)
        own = self.corrected(sample.z)
        found = own.probe(near, 0.0, near.z.copy(), finer, SETTINGS)
        return None if found is None else (own, found, finer)

    def corrected(self, z: Array) -> Self:
        """The curve of equations that are nearer to what is meant than those solved, where there are such."""
        base = self.base.corrected(z)
        return self if base is self.base else replace(self, base=base)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """As solved on the mesh of the curve, with the error by which it moves on a finer one."""
        found = super().verify(type_, near, frame)
        if type_ == "CP" and self.type == "LP":
            touching = self.base.touching(self, found.z if isinstance(found, Verified) else near.z, frame)
            if touching is not None:
                return cast("Outcome", touching)
        if not isinstance(found, Verified):
            return found
        sample, finer = self.finer(replace(near, z=found.z), frame)
        again = events.verify(self.corrected(sample.z).beside(sample.z, finer), type_, sample, finer)
        if not isinstance(again, Verified):
            return unverified(type_, "it is not there on a mesh of twice as many intervals")
        moved = ORDER * np.abs(again.z[[-1, -2]] - found.z[[-1, -2]])
        known = {k: float(found.vectors[k]) + float(moved[1]) for k in ("second",) if k in found.vectors}
        return replace(found, error=found.error + float(moved[0]), vectors={**found.vectors, **known})

    def end_at(self, point: Verified) -> End | None:
        if not point.vectors.get("mirrored"):
            return None
        at = float(point.z[-1])
        text = f"met its own mirror image on the curve of branch points at {self.parameters[0]} = {at:.10g}"
        return End("joined", text, {"at": at})

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        changed = [
            t for t in self.base.types(self.type)
            if (k := self.test_of(t)) is not None and opposite(a.tests[k], b.tests[k])
        ]  # fmt: skip
        return [self.verify(type_, a, frame) for type_ in changed]

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        count = len(self.names)
        slack = ONE_POINT * scale[-count:] + 3.0 * (a.error + b.error)
        return bool(np.all(np.abs(a.z[-count:] - b.z[-count:]) <= slack))
