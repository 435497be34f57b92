"""A special point of the problem without conditions at which the conditions are met."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Nothing, Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample
from contin.problems.conditioned.conditioned_equations import ConditionedEquations
from contin.problems.tolerances import STALLED

ITERATIONS: Final = 12
DIFFERENCE: Final = 1e-5  # part of a free parameter's scale by which it is moved for a derivative
SOLVED: Final = 1e-12  # of the conditions, relative to their change over the scale of the free parameters


@dataclass(frozen=True, eq=False)
class Intersection:
    """A special point of the problem without conditions, unfolded by one of the k + 1 parameters, on the conditions.

    place : of the parameter that unfolds it, among (free parameters, varying one); the others are solved for.
    """

    problem: ConditionedEquations
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
