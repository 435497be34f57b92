"""What solutions under conditions have in common, whatever they are.

Stability is that of the solution with all parameters fixed. A special point of it is one of the family without
conditions, for those values of the free parameters for which it meets them; folds of the conditioned curve itself are
LP with `of: curve` in their normal form.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation import corrector
from contin.continuation import march as python_march
from contin.continuation.choices import Choices
from contin.continuation.homotopy import without_offset
from contin.continuation.outcome import NOTHING, Nothing, Outcome, Rejected, Verified, unverified
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.conditioned.conditioned_equations import ConditionedEquations
from contin.problems.conditioned.intersection import Intersection
from contin.problems.conditioned.zero_along import zero_along
from contin.problems.surfaces.of_parameters import choices_of
from contin.problems.tolerances import ONE_FIXED

TURN: Final = "turn"  # a fold of the conditioned curve, until it is labelled LP
CURVE_BP: Final = "crossing"
TEST_OF: Final = {  # the test whose zero a labelled point is
    "LP": "zero", "BP": "zero", "LPC": "zero", "BPC": "zero", "HB": "pair", "NS": "pair", "PD": "flip",
}  # fmt: skip
ZERO: Final = 2  # place of the test of an eigenvalue 0 (multiplier 1) among all
TOUCHING: Final = 1e-6  # of it: it may be zero there, without another sign beyond


@dataclass(frozen=True, eq=False)
class Conditioned(ConditionedEquations):
    """A kind of solutions adds what `ConditionedEquations` asks, finer meshes, and types of special points."""

    TESTS: ClassVar[tuple[str, ...]] = ()  # what each test from the third on tells

    @abstractmethod
    def finer(self, near: Sample, frame: Frame) -> tuple[Conditioned, Sample, Frame] | None:
        """The same on a finer mesh, where there is one."""

    @abstractmethod
    def inner_type(self, test: str, near: Sample, also: Collection[str]) -> str | None:
        """The type of the special point that a test's zero is for the problem without conditions."""

    # -- the engine's contract -----------------------------------------------------------------------------------------

    @property
    def kind(self) -> str:
        return str(self.inner.kind)

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(self.inner.parameters)

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    maximum_chunk = 10

    def constants(self) -> dict[str, float]:
        found: dict[str, float] = self.inner.constants()
        return found

    @property
    def formulas(self) -> object:
        return self.inner.formulas

    def choices(self, z: Array) -> Choices:
        return choices_of(self, z)

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        found: tuple[float, float] | None = self.inner.default_range(parameter)
        return found

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without eigenvalues (multipliers) of algebraic equations."""
        return np.asarray(self.inner.finite(self._bare(z), values))

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        rows = np.array([self._bare(row) for row in z])
        for row, (point, bare) in enumerate(zip(z, rows, strict=True)):
            left = self.at(self.free_values(point)).left_reach(bare[None])
            if left is not None:
                return row, str(left[1])
        return None

    def _bare(self, z: Array) -> Array:
        return self.inner_vector(z)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The null vector of the equations and conditions."""
        tangent = python_march.null_vector(self, z, scale, np.random.default_rng(3).normal(size=z.size), 3)
        if tangent is None:
            raise InputError(f"the curve cannot be followed from here. {self.describe_failure(z)}")
        return [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        still = _Still(self, self.march_periods(origin.z))
        limit = min(limit, self.maximum_chunk)
        return python_march.march(still, origin, before, length, frame, step, limit, bounds, settings, loop)

    def march_periods(self, z: Array) -> Array:
        """Periods of unknowns that are angles, 0 for those whose metric may be outgrown, endless for all others."""
        return np.asarray(self.angle_periods)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(_Still(self, np.zeros(0)), base, length, guess, frame, settings)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        finer = self.finer(sample, frame)
        if finer is None:
            return None
        problem, moved, there = finer
        found = problem.probe(moved, 0.0, moved.z, there, Settings())
        return None if found is None else (problem, found, there)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return python_march.with_one_fixed(self, -1, guess, value, scale, ONE_FIXED)

    def onto_conditions(self, z: Array, scale: Array) -> Array | None:
        """From a solution to one that meets the conditions, at the same value of the varying parameter."""

        def solved(offset: Array, guess: Array) -> Array | None:
            return self.shifted(offset, guess).at_parameter(guess, float(guess[-1]), scale)

        return without_offset(z, self.condition_values(z), solved)

    @abstractmethod
    def shifted(self, offset: Array, z: Array) -> Conditioned:
        """The same with conditions c = offset, near the solution z."""

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        """One event for each test that changes its sign; None where they do not account for the count."""
        crossed = [name for name, x in zip((TURN, CURVE_BP, *self.TESTS), a.tests * b.tests, strict=True) if x < 0.0]
        moved = abs(a.unstable - b.unstable)
        counted = sum({"zero": 1, "flip": 1, "pair": 2}.get(name, 0) for name in crossed)
        if moved > counted or (counted - moved) % 2:
            return None
        if "zero" in crossed and CURVE_BP in crossed:  # a branch point of the family is one of the curve, too
            crossed = [name for name in crossed if name not in (CURVE_BP, TURN)]
        return tuple(crossed) if len(crossed) <= 1 else None

    def test_of(self, type_: str) -> int | None:
        names, name = (TURN, CURVE_BP, *self.TESTS), TEST_OF.get(type_, type_)
        return names.index(name) if name in names else None

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        if type_ == TURN:
            return self._turn(near, frame)
        if type_ == CURVE_BP:  # where a stability only touches zero: the top of a pitchfork's side branch
            point = self._of_test("zero", near, frame, {CURVE_BP})
            words = "a branch point of the curve of conditioned solutions alone, not labelled"
            return point if isinstance(point, Verified) else Rejected(words)
        return self._of_test(type_, near, frame, ())

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        crossed = [name for name, x in zip((TURN, CURVE_BP, *self.TESTS), a.tests * b.tests, strict=True) if x < 0.0]
        found: list[Outcome] = []
        if CURVE_BP in crossed and "zero" not in crossed:
            found.append(self.verify(CURVE_BP, a, frame))
            done = (CURVE_BP, TURN) if isinstance(found[0], Verified) else (CURVE_BP,)
            crossed = [name for name in crossed if name not in done]
        for name in crossed:
            if name in (TURN, CURVE_BP) and "zero" in crossed:
                continue
            beside = {TURN, CURVE_BP} & set(crossed)
            together = name == "zero" and beside
            found.append(self._beside_turns(a, frame, beside) if together else self.verify(name, a, frame))
        return found

    def _beside_turns(self, near: Sample, frame: Frame, beside: Collection[str]) -> Outcome:
        """A zero where the curve turns, too: a fold that depends on no free parameter, else a branch point."""
        fold = NOTHING if CURVE_BP in beside else self._of_test("zero", near, frame, ())
        return fold if isinstance(fold, Verified) else self._of_test("zero", near, frame, beside)

    def _of_test(self, test: str, near: Sample, frame: Frame, also: Collection[str]) -> Outcome:
        inner = self.inner_type(test, near, also)
        return NOTHING if inner is None else self._solved(inner, near, frame)

    def alone(self, z: Array, tangent: Array, scale: Array) -> tuple[Problem, Array, Array, Array]:
        problem: Problem = self.at(self.free_values(z))
        return problem, self.inner_vector(z), self.inner_vector(tangent), self.inner_vector(scale)

    # -- special points ------------------------------------------------------------------------------------------------

    def _turn(self, near: Sample, frame: Frame) -> Outcome:
        """A fold of the curve: where the parameter turns along it."""
        found = zero_along(self, near, frame, lambda sample: float(sample.tangent[-1]))
        if found is None:
            return unverified("LP", "the parameter does not turn at one point of the curve")
        sample, left, error = found
        finer = self.finer(sample, frame)
        if finer is not None:
            again = zero_along(finer[0], finer[1], finer[2], lambda s: float(s.tangent[-1]))
            if again is None:
                return unverified("LP", "it is not there on a mesh of twice as many intervals")
            error += 1.25 * abs(float(again[0].z[-1] - sample.z[-1]))
        if abs(float(sample.tests[ZERO])) < TOUCHING:
            point = self._of_test("zero", sample, frame, {CURVE_BP})
            if isinstance(point, Verified):  # the curve turns since the branch does, at a branch point
                return point
        form = {"of": "curve", "parameter": self.parameters[0]}
        remark = "LP: a fold of the curve of solutions that meet the conditions, not of solutions at fixed parameters"
        return Verified("LP", sample.z, abs(left), error, sample.eigenvalues, sample.unstable, form, {}, remark=remark)

    def _solved(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """The special point of the problem without conditions that meets them."""
        found = self._on_conditions(type_, near, frame)
        if not isinstance(found, tuple):
            return found
        point, z, left = found
        error, finer = point.error + left * float(frame.scale[-1]), self.finer(near, frame)
        if finer is not None:
            again = finer[0]._on_conditions(type_, finer[1], finer[2])
            if not isinstance(again, tuple):
                return unverified(type_, "it is not there on a mesh of twice as many intervals")
            error += 1.25 * abs(float(again[1][-1] - z[-1]))
        return replace(point, z=z, residual=max(point.residual, left), error=error)

    def _on_conditions(
        self, type_: str, near: Sample, frame: Frame
    ) -> tuple[Verified, Array, float] | Rejected | Nothing:
        """(point, z, what is left of the conditions), unfolded by the varying parameter or else by a free one."""
        first = None
        for place in (self.k, *range(self.k)):
            found = Intersection(self, type_, near, frame, place).solve()
            if isinstance(found, tuple):
                return found
            first = first or found
        return first or NOTHING


@dataclass(frozen=True, eq=False)
class _Still:
    """A problem none of whose unknowns is an angle, as the march in Python takes it."""

    problem: Conditioned
    angle_periods: Array

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> corrector.Linearisation | None:
        return self.problem.linearisation(z, tangent, scale)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return self.problem.stability(z)


def product_of(factors: Vector) -> float:
    """A bounded product whose sign changes with each real factor's."""
    return float(np.real(np.prod(factors / (1.0 + np.abs(factors))))) if factors.size else 1.0
