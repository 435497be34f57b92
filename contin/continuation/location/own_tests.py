"""Special points of types that bring a test function of their own, such as those of plugins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found
from contin.continuation.location.user_value import zero_between
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Sample
from contin.special.special_type import SpecialType
from contin.special.table import with_own_test

JUMP = 1e-6  # of the values at the ends: a larger one at the point found is no zero


@dataclass(frozen=True)
class OwnTest:
    """Points of one type: zeros of its test function along a branch."""

    row: SpecialType
    value: float = 0.0

    @property
    def column(self) -> str:
        return self.row.words

    def values(self, problem: Problem, z: Array) -> Array:
        test = self.row.test
        assert test is not None
        return np.array([test(problem, row) for row in z], dtype=float)

    def locate(self, stretch: Stretch, z_a: Array, z_b: Array) -> Found | None:
        """The labelled point; None where the function only jumps from one sign to the other."""

        def value(sample: Sample) -> float:
            return float(self.values(stretch.problem, sample.z[None, :])[0])

        size = max(abs(float(v)) for v in self.values(stretch.problem, np.stack([z_a, z_b])))
        near, distance = zero_between(stretch, z_a, z_b, value)
        residual = abs(value(near))
        if not residual <= JUMP * size:
            return None
        form = {} if self.row.form is None else dict(self.row.form(stretch.problem, near.z))
        error = distance * float(stretch.frame.scale[-1])
        point = Verified(self.row.code, near.z, residual, error, near.eigenvalues, near.unstable, form)
        return Found(stretch.length_of(near), point, near)


def own_tests(problem: Problem) -> tuple[OwnTest, ...]:
    """One for each type that is looked for on the branches of a problem."""
    return tuple(OwnTest(row) for row in with_own_test(problem.kind, problem.locus))
