"""Balancing: the same scales as LAPACK's, whatever the units."""

import numpy as np
import pytest
from scipy.linalg import matrix_balance

from contin.linalg.balancing import balancing_scales


def lapack(a):
    with np.errstate(invalid="ignore"):
        return matrix_balance(a, permute=False, separate=True)[1][0]


@pytest.mark.parametrize("seed", range(40))
def test_scales_are_those_of_lapack(seed):
    chance = np.random.default_rng(seed)
    n = int(chance.integers(1, 12))
    a = chance.standard_normal((n, n)) * (chance.random((n, n)) < chance.uniform(0.3, 1.0))
    units = 10.0 ** chance.uniform(-seed / 2, seed / 2, n)
    a = a / units[:, None] * units
    np.testing.assert_array_equal(balancing_scales(a), lapack(a))


def test_rows_and_columns_have_like_norms_in_any_units():
    chance = np.random.default_rng(1)
    a = chance.standard_normal((6, 6))
    units = 2.0 ** chance.integers(-60, 60, 6)
    b = a / units[:, None] * units
    d = balancing_scales(b)
    balanced = b / d[:, None] * d
    ratios = np.linalg.norm(balanced, axis=0) / np.linalg.norm(balanced, axis=1)
    assert np.all((ratios > 0.25) & (ratios < 4.0))  # powers of two, and off the diagonal alone


def test_zeros_and_what_is_not_finite_are_left_alone():
    np.testing.assert_array_equal(balancing_scales(np.zeros((3, 3))), np.ones(3))
    np.testing.assert_array_equal(balancing_scales(np.array([[1.0, np.nan], [1e9, 1.0]])), np.ones(2))
    a = np.array([[1.0, 1e8, 0.0], [1e-8, 1.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(balancing_scales(a), lapack(a))
