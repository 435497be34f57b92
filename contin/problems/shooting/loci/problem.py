"""Curves of LPC, PD, NS and BPC of orbits found by shooting, as a continuation problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import Chunk, Frame, Renewal, Sample, Verified
from contin.continuation.settings import Settings
from contin.problems.orbits.columns import names_of
from contin.problems.orbits.loci import criticality, events
from contin.problems.orbits.loci.special import OfSpecialOrbits
from contin.problems.orbits.marched_in_python import MarchedInPython
from contin.problems.orbits.multipliers import nontrivial
from contin.problems.shooting.linear import BorderedShooting
from contin.problems.shooting.loci import corners
from contin.problems.shooting.loci.curve import CurveByShooting
from contin.problems.shooting.loci.grazing import GrazingCurve


@dataclass(frozen=True, eq=False)
class ShotLocusProblem(MarchedInPython, OfSpecialOrbits):
    """See `contin.problems.shooting.loci.curve` for the unknowns and equations.

    Cost of a Newton step: the orbit's trajectories three times (LPC, PD), five times (NS, BPC) or once (touching
    orbits), each with n + 2 variations, and a dense solve of size M n + 3 (NS, BPC: M n + 5).
    """

    curve: CurveByShooting

    maximum_chunk = 10

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        own = self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first))
        return self.curve.join(own, second, 1.0)

    def settle(self, z: Array, scale: Array) -> None:
        self.curve.settle(z, scale)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> BorderedShooting | None:
        found = self.curve.linearise(z, scale)
        if found is None or not np.all(np.isfinite(found.jacobian)):
            return None
        where = self.curve.unknowns(z)
        return BorderedShooting(found.residual, np.vstack([found.jacobian, tangent[where]]), where, z.size)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests as `contin.problems.orbits.loci.events` names them; the multipliers that are not critical decide."""
        from contin.kernels.tests_of_stability import map_tests

        values, four = self.multipliers(z), np.ones(4)
        touching = self.curve.touched is not None  # no multiplier is critical, on either side of the touched surface
        others = nontrivial(self.curve.orbits, values) if touching else self.others(values, z)
        unstable = int(map_tests(np.ascontiguousarray(others.real), np.ascontiguousarray(others.imag), four))
        if touching:
            return np.full(len(events.NAMES[self.locus]), np.nan), unstable, values
        tests = [four[2] if others.size > 1 else 1.0, four[3], ones(others)]
        if self.locus == "LPC":
            tests.append(self.curve.bend())
        elif self.locus == "PD":
            tests.append(np.nan)
        elif self.locus == "NS":
            k = self.curve.further(z)
            tests += [k - 1.0, k + 1.0, k + 0.5, k, np.nan]
        return np.array(tests), unstable, values

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        chunk = corners.cut_where_wrong(self, chunk, frame.scale)
        return criticality.cut_at_change(self.curve, chunk, frame.scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        found = super().probe(base, length, guess, frame, settings)
        if found is None or not criticality.is_measured(self.curve, base):
            return found
        return criticality.measured(self.curve, found, frame.scale)

    def cross_corner(self, last: Sample, frame: Frame, settings: Settings) -> tuple[Sample, Verified | None] | None:
        return corners.cross_corner(self, last, frame)

    def describe_failure(self, z: Array) -> str:
        return corners.why_not(self, z) or super().describe_failure(z)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Verified | str:
        from contin.problems.shooting.loci.verify import verify

        return verify(self, type_, near, frame)

    def precise(self, accuracy: float) -> ShotLocusProblem:
        """The same curve with trajectories of another accuracy."""
        return replace(self, curve=self.curve.precise(accuracy))

    def refined(self, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame] | None:
        return None

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        from contin.problems.shooting.loci.renewal import renew

        return renew(self, origin, before, frame)

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, period, and smallest and largest value over the orbit of every state and observable."""
        from contin.problems.shooting.sampling import extremes

        curve = self.curve
        columns = self.parameter_columns(z)
        columns["period"] = z[:, curve.orbits.count * curve.orbits.n].copy()
        both = [extremes(curve.at(row), curve.orbit(row)[None]) for row in z]
        for k, name in enumerate(names_of(self.system)):
            columns[f"{name}.min"] = np.array([low[0, k] for low, _ in both])
            columns[f"{name}.max"] = np.array([high[0, k] for _, high in both])
        if isinstance(curve, GrazingCurve) and len(z):
            scale = self.initial_scale(z[0], self.first_bounds)
            columns["turns"] = np.array([curve.turns(row, scale) for row in z])
        return columns | self.angle_columns(z)

    def remarks(self, z: Array) -> Sequence[str]:
        touched = self.curve.touched
        if touched is None:
            return ()
        surface = self.system.pieces.name(touched)
        return (f"the orbits touch {surface}: nonsmooth folds where `turns` is true; other events are not looked for",)

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        """The curves of other types through a point where two meet; its own where there is no other."""
        from contin.problems.shooting.loci.start import loci_through

        return loci_through(self, point, parameters)


def ones(values: NDArray[np.complex128]) -> float:
    """Sign of the product of all (1 - multiplier), size of the smallest factor relative to 1 + |multiplier|."""
    if not values.size:
        return 1.0
    below = np.count_nonzero((values.imag == 0.0) & (values.real > 1.0))
    return float((-1.0) ** below * np.min(np.abs(values - 1.0) / (1.0 + np.abs(values))))
