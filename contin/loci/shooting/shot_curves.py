"""What all curves of orbits found by shooting have in common as continuation problems."""

from __future__ import annotations

from dataclasses import dataclass

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.loci.shooting import corners
from contin.loci.shooting.renewal import renew
from contin.loci.shooting.shot_curve_equations import ShotCurveEquations


@dataclass(frozen=True, eq=False)
class OfShotOrbits(ShotCurveEquations):
    """The equations of `ShotCurveEquations`, with touched surfaces and phases that move."""

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        return corners.cut_where_wrong(self.with_gauge(chunk.gauge), chunk, frame.scale)

    def cross_corner(self, last: Sample, frame: Frame, settings: Settings) -> tuple[Sample, Verified | None] | None:
        return corners.cross_corner(self.with_gauge(frame.gauge), last, frame)

    def describe_failure(self, z: Array) -> str:
        return corners.why_not(self, z) or super().describe_failure(z)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        return renew(self.with_gauge(frame.gauge), origin, before, frame)
