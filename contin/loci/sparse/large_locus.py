"""Curves of folds and Hopf points of large systems as a continuation problem in two parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.corrector import IN_TWO_PARAMETERS
from contin.continuation.outcome import NOTHING, Outcome, unverified
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.loci.codim2.events import explain as explain_events
from contin.loci.codim2.events import test_of
from contin.loci.curve_of_points import scalar_columns
from contin.loci.neutral import with_told_crossings
from contin.loci.sparse import events
from contin.loci.sparse.on_large_curve import OnLargeCurve
from contin.problems.state_columns import state_columns

POLISHED = Rules(settled=1e-14, stalled=1e-6, far=1.0, ratio=0.9, budget=60)  # beside singular points: a series


@dataclass(frozen=True, eq=False)
class LargeLocus(OnLargeCurve):
    """See `LargeCurve`; `second_bounds` is the range of the second parameter, that of the first is the engine's."""

    # evaluation -------------------------------------------------------------------------------------------------------

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return events.tests_at(self, z)

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        branch, point = self.curve.branch(z)
        states = branch.initial_scale(point, bounds)
        middle = []
        if self.curve.has_scalar:
            middle = [self.curve.unit_at(z) if self.curve.kappa(z) != 0.0 else self.curve.unit]
        return np.concatenate([states[:-1], middle, [self.widths(z, bounds)[1], float(states[-1]) / 2.0]])

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        self.curve.precisely(z)
        tangent = python_march.null_vector(self, z, scale, np.random.default_rng(5).normal(size=len(z)), 1)
        return [] if tangent is None else [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        known = self.curve.gauged(frame.gauge)
        own = replace(self, curve=known.settled(origin.z, origin.tangent * frame.scale))
        chunk = python_march.march(
            own, origin, before, length, frame, step, limit, bounds, settings, loop, walled=self,
            decisions=IN_TWO_PARAMETERS,
        )  # fmt: skip
        return with_told_crossings(self.locus, replace(chunk, gauge=own.curve.gauge))

    def _beside(self, frame: Frame) -> Self:
        """The curve as it is looked at next to a chunk."""
        return replace(self, curve=self.curve.gauged(frame.gauge))

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self._beside(frame), base, length, guess, frame, settings)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        start = guess.copy()
        start[index] = value
        row = np.zeros(len(start))
        row[index] = 1.0
        own = self.curve.settled(guess, None)

        def correct(z: Array) -> tuple[float, Array] | None:
            here = own.linearisation(z, row, scale)
            if here is None:
                return None
            step = here.solve(np.append(-here.residual, 0.0))
            there = z + step * scale
            there[index] = value
            return norm(step), there

        found = newton(correct, start, POLISHED)
        return None if found is None else found.at

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return explain_events(self.locus, a, b)

    def test_of(self, type_: str) -> int | None:
        return test_of(self.locus, type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        if type_ == "neutral":
            return NOTHING
        self.curve.precisely(near.z)
        try:
            return events.verify(self._beside(frame), type_, near, frame)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            return unverified(type_, str(error))

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return [self.verify(type_, a, frame) for type_ in events.crossed(self.locus, a, b)]

    def columns(self, z: Array) -> dict[str, Array]:
        rows = [self.curve.branch(row) for row in z]
        points = np.array([point for _, point in rows])
        columns = self.parameter_columns(z)
        plain = replace(self.curve.origin, active=self.curve.first)
        columns.update({k: v for k, v in plain.columns(points).items() if k not in columns})
        columns |= state_columns(
            self.system, z[:, : self.n], lambda: np.array([self.curve.full_parameters(row) for row in z])
        )
        return columns | scalar_columns(self.locus, z[:, -3])

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        return []

    def describe_failure(self, z: Array) -> str:
        return self.system.why_not_finite(z[: self.n], self.curve.full_parameters(z)) or (
            "The defining system may be singular here (two such curves cross). Try a smaller settings.step or min_step."
        )
