"""What solutions under conditions have in common, whatever they are.

z = (unknowns of the solution, q_k .. q_1, p): the free parameters q stand before the one that varies. Stability is that
of the solution with all parameters fixed. A special point of it is one of the family without conditions, for those
values of q for which it meets them; folds of the conditioned curve itself are LP with `of: curve` in their normal form.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation import march as python_march
from contin.continuation.homotopy import without_offset
from contin.continuation.outcome import NOTHING, Nothing, Outcome, Rejected, Verified, unverified
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.conditioned.secant import zero_along
from contin.problems.scales import parameter_width

TURN: Final = "turn"  # a fold of the conditioned curve, until it is labelled LP
CURVE_BP: Final = "crossing"
TEST_OF: Final = {  # the test whose zero a labelled point is
    "LP": "zero", "BP": "zero", "LPC": "zero", "BPC": "zero", "HB": "pair", "NS": "pair", "PD": "flip",
}  # fmt: skip
TOLERANCE: Final = 1e-11
ITERATIONS: Final = 12
DIFFERENCE: Final = 1e-5  # part of a free parameter's scale by which it is moved for a derivative
SOLVED: Final = 1e-12  # of the conditions, relative to their change over the scale of the free parameters
STALLED: Final = 1e-7
SMALL: Final = 1e-3  # part of its natural size below which a free parameter's value says nothing of its scale


@dataclass(frozen=True, eq=False)
class Conditioned(Problem):
    """`inner`: the problem without conditions, whose base has values of the free parameters; `free`: their places."""

    inner: Any
    free: tuple[int, ...]

    locus = None
    TESTS: ClassVar[tuple[str, ...]] = ()  # what each test from the third on tells

    # -- the parts of z ------------------------------------------------------------------------------------------------

    @property
    def k(self) -> int:
        return len(self.free)

    def inner_vector(self, z: Array) -> Array:
        """z of the problem without conditions (also of a metric or tangent)."""
        return np.append(z[: -1 - self.k], z[-1])

    def joined(self, inner: Array, free: Array) -> Array:
        """z from both parts; free parameters in their order."""
        return np.concatenate([inner[:-1], free[::-1], inner[-1:]])

    def free_values(self, z: Array) -> Array:
        """The free parameters, in their order."""
        return z[-1 - self.k : -1][::-1]

    def at(self, q: Array) -> Any:
        """The problem without conditions for these values of the free parameters."""
        base = self.inner.base.copy()
        base[list(self.free)] = q
        return replace(self.inner, base=base)

    @property
    def free_names(self) -> tuple[str, ...]:
        return tuple(self.inner.system.parameter_names[k] for k in self.free)

    # -- what the kinds of solutions add -------------------------------------------------------------------------------

    @abstractmethod
    def linearisation(self, z: Array, tangent: Array, scale: Array) -> python_march.Linearisation | None:
        """Equations and conditions with the tangent as their last row."""

    @abstractmethod
    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on (named by TESTS), the number of unstable eigenvalues, and all of them."""

    @abstractmethod
    def condition_values(self, z: Array) -> Array:
        """(k,)"""

    @abstractmethod
    def near_inner(self, near: Sample, z: Array, frame: Frame, place: int) -> tuple[Sample, Frame]:
        """A sample at z of the problem without conditions, in which parameter `place` varies, and its metric."""

    def _unfolded(self, z: Array, scale: Array, place: int) -> tuple[Any, Array, Array]:
        """The problem without conditions in which parameter `place` varies (k: the own one), its z and metric."""
        free, bare, metric = self.free_values(z), self.inner_vector(z), self.inner_vector(scale)
        inner = self.at(free)
        if place == self.k:
            return inner, bare, metric
        inner = inner.with_active(self.free_names[place], bare)
        return inner, np.append(bare[:-1], free[place]), np.append(metric[:-1], self.free_values(scale)[place])

    @abstractmethod
    def finer(self, near: Sample, frame: Frame) -> tuple[Conditioned, Sample, Frame] | None:
        """The same on a finer mesh, where there is one."""

    @abstractmethod
    def inner_type(self, test: str, near: Sample, also: Sequence[str]) -> str | None:
        """The type of the special point that a test's zero is for the problem without conditions."""

    def free_widths(self, z: Array, states: Array) -> Array:
        """Scales of the free parameters: declared ones or their values; of one that is as good as 0, the value that
        would change the equations as much as the states (rows) do."""
        bare, free = self.at(self.free_values(z)), self.free_values(z)
        p, n = bare.full_parameters(self.inner_vector(z)), states.shape[1]
        slopes = np.abs(np.array([self.system.jacobian(u, p)[1] for u in states]))
        size = np.abs(states).max(axis=0)
        effect = float((slopes[:, :, :n] * np.where(size > 0.0, size, size.max(initial=0.0) or 1.0)).max())
        widths = []
        for name, place, value in zip(self.free_names, self.free, free, strict=True):
            own = float(slopes[:, :, n + place].max())
            natural = effect / own if own > 0.0 and effect > 0.0 else abs(float(value)) or 1.0
            given = abs(float(value)) if abs(float(value)) > SMALL * natural else natural
            widths.append(parameter_width(self.system.model, name, given, (-np.inf, np.inf)))
        return np.array(widths)

    # -- the engine's contract -----------------------------------------------------------------------------------------

    @property
    def kind(self) -> str:
        return str(self.inner.kind)

    @property
    def system(self) -> Any:
        return self.inner.system

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
        return python_march.with_one_fixed(self, -1, guess, value, scale, TOLERANCE)

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
        if type_ == CURVE_BP:
            return Rejected("a branch point of the curve of conditioned solutions alone, not labelled")
        inner = self.inner_type(type_, near, ())
        return NOTHING if inner is None else self._solved(inner, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        crossed = [name for name, x in zip((TURN, CURVE_BP, *self.TESTS), a.tests * b.tests, strict=True) if x < 0.0]
        found: list[Outcome] = []
        for name in crossed:
            if name in (TURN, CURVE_BP) and "zero" in crossed:
                continue
            if name == "zero" and {TURN, CURVE_BP} & set(crossed):
                inner = self.inner_type(name, a, crossed)
                found.append(NOTHING if inner is None else self._solved(inner, a, frame))
            else:
                found.append(self.verify(name, a, frame))
        return found

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
            found = _Intersection(self, type_, near, frame, place).solve()
            if isinstance(found, tuple):
                return found
            first = first or found
        return first or NOTHING


@dataclass(frozen=True, eq=False)
class _Intersection:
    """A special point of the problem without conditions, unfolded by one of the k + 1 parameters, on the conditions.

    place : of the parameter that unfolds it, among (free parameters, varying one); the others are solved for.
    """

    problem: Conditioned
    type_: str
    near: Sample
    frame: Frame
    place: int

    @property
    def others(self) -> list[int]:
        return [k for k in range(self.problem.k + 1) if k != self.place]

    def _all(self, z: Array) -> Array:
        """Free parameters, and the varying one."""
        return np.append(self.problem.free_values(z), z[-1])

    def point_at(self, values: Array, z: Array) -> tuple[Verified, Array] | Rejected | Nothing:
        """The point for these values of the other parameters, near z, and its z."""
        problem, every = self.problem, self._all(z)
        every[self.others] = values
        start = problem.joined(np.append(problem.inner_vector(z)[:-1], every[-1]), every[:-1])
        sample, metric = problem.near_inner(self.near, start, self.frame, self.place)
        inner = problem.at(every[:-1])
        if self.place < problem.k:
            inner = inner.with_active(problem.free_names[self.place], np.append(sample.z[:-1], every[-1]))
        found: Outcome = inner.verify(self.type_, sample, metric)
        if not isinstance(found, Verified):
            return found
        every[self.place] = found.z[-1]
        return found, problem.joined(np.append(found.z[:-1], every[-1]), every[:-1])

    def solve(self) -> tuple[Verified, Array, float] | Rejected | Nothing:
        """Newton's method with differences, then Broyden's."""
        problem, type_ = self.problem, self.type_
        widths = self._all(self.frame.scale)[self.others]
        values = self._all(self.near.z)[self.others]
        here = self.point_at(values, self.near.z)
        if not isinstance(here, tuple):
            return here
        c = problem.condition_values(here[1])
        matrix = np.empty((problem.k, problem.k))
        for j in range(problem.k):
            there = self.point_at(values + DIFFERENCE * widths * (np.arange(problem.k) == j), here[1])
            if not isinstance(there, tuple):
                return there
            matrix[:, j] = (problem.condition_values(there[1]) - c) / DIFFERENCE  # by value / width
        before = np.inf
        for _ in range(ITERATIONS):
            try:
                step = np.linalg.solve(matrix, -c)
            except np.linalg.LinAlgError:
                return unverified(type_, "its curve is tangent to the conditions")
            size = float(np.abs(step).max())
            if not np.isfinite(size) or size > 1.0:
                return unverified(type_, "no such point meets the conditions nearby")
            if size <= SOLVED or (size >= 0.5 * before and size <= STALLED):
                share = float(self.frame.scale[-1] / self._all(self.frame.scale)[self.place])
                return replace(here[0], error=share * here[0].error), here[1], size
            values = values + widths * step
            there = self.point_at(values, here[1])
            if not isinstance(there, tuple):
                return there
            moved = problem.condition_values(there[1])
            matrix = matrix + np.outer(moved - c - matrix @ step, step) / float(step @ step)
            here, c, before = there, moved, size
        return unverified(type_, "the conditions were not met to full precision")


@dataclass(frozen=True, eq=False)
class _Still:
    """A problem none of whose unknowns is an angle, as the march in Python takes it."""

    problem: Conditioned
    angle_periods: Array

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> python_march.Linearisation | None:
        return self.problem.linearisation(z, tangent, scale)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return self.problem.stability(z)


def product_of(factors: Vector) -> float:
    """A bounded product whose sign changes with each real factor's."""
    return float(np.real(np.prod(factors / (1.0 + np.abs(factors))))) if factors.size else 1.0
