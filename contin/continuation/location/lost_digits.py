"""Where multipliers say nothing: the largest is so large that beside it rounding in the others is of order one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Vector
from contin.continuation.problem import Problem
from contin.continuation.sample import Sample


def unresolved(problem: Problem, multipliers: Vector) -> NDArray[np.bool_]:
    """(rows,) from multipliers (rows, k), of fixed points and cycles of maps; those of a cycle of length k are products
    of k matrices, which grow like the k-th power where a cycle goes to infinity. Of orbits by shooting, too: they are
    those of a product over the period. False for other problems."""
    if not (problem.kind == "fixed-point" or problem.multiplied_out) or multipliers.shape[1] < 2:
        return np.zeros(len(multipliers), bool)
    largest = np.abs(multipliers).max(axis=1)
    return np.asarray(~(largest * np.finfo(float).eps < 1.0))


def turning_alone(sample: Sample) -> Sample:
    """The sample with the one test that needs no multipliers: whether the parameter turns."""
    return replace(sample, tests=np.append(sample.tests[:1], np.ones(len(sample.tests) - 1)), unstable=0)
