"""Equilibration: small matrices are scaled as Python's numbers, with the same powers of two as large ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.normalforms import linear


def spread(seed: int) -> np.ndarray:
    """A matrix of up to 7 x 7 with zeros, entries over 24 orders of magnitude, some complex or exact powers of two."""
    generator = np.random.default_rng(seed)
    shape = generator.integers(1, 8, 2)
    matrix = generator.normal(size=shape) * 10.0 ** generator.integers(-12, 12, shape)
    if seed % 3 == 0:
        matrix = 2.0 ** generator.integers(-30, 30, shape)
    if seed % 3 == 1:
        matrix = matrix + 1j * generator.normal(size=shape)
    matrix[generator.random(shape) < 0.3] = 0.0
    return matrix


@given(seed=st.integers(0, 10_000))
@settings(max_examples=100, deadline=None)
def test_small_matrices_get_the_powers_of_two_of_large_ones(seed):
    matrix = spread(seed)
    few = linear.equilibrate(matrix)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(linear, "FEW", 0)
        many = linear.equilibrate(matrix)
    for one, other in zip(few, many, strict=True):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(np.frexp(one)[0], 0.5)  # powers of two
