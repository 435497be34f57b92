"""Curves whose unknowns follow a mesh: their points, with errors told from a finer one."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self, cast

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified, unverified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample, opposite
from contin.continuation.settings import Settings
from contin.loci.augmented import events
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.problems.tolerances import ONE_POINT

SETTINGS: Final = Settings()
ORDER: Final = 1.25  # the finer mesh leaves an error of its own, 2^-2m of this one


@dataclass(frozen=True, eq=False)
class CurveOnMeshes(AugmentedCurve):
    """A leaf says what a mesh that fits is, and what a finer one."""

    base: Any

    adaptive = True

    @abstractmethod
    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """See `contin.continuation.problem.Problem`."""

    @abstractmethod
    def finer(self, near: Sample, frame: Frame) -> tuple[Sample, Frame] | None:
        """A sample and its metric where every interval is halved; None where there is none."""

    def refined(self, sample: Sample, frame: Frame) -> tuple[CurveOnMeshes, Sample, Frame] | None:
        """Of a point of the curve that has no defining system (a user value), by which its error is told."""
        fine = self.finer(sample, frame)
        if fine is None:
            return None
        near, finer = fine
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
        fine = self.finer(replace(near, z=found.z), frame)
        if fine is not None:
            sample, finer = fine
            again = events.verify(self.corrected(sample.z).beside(sample.z, finer), type_, sample, finer)
        if fine is None or not isinstance(again, Verified):
            return unverified(type_, "it is not there on a mesh of twice as many intervals")
        moved = ORDER * np.abs(again.z[[-1, -2]] - found.z[[-1, -2]])
        known = {k: float(found.vectors[k]) + float(moved[1]) for k in ("second",) if k in found.vectors}
        return replace(found, error=found.error + float(moved[0]), vectors={**found.vectors, **known})

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
