"""LU factors against numpy: the equation P A = L U, the sign of det P, and backward error."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contin.kernels.dense import lu_factor, lu_solve

EPS = np.finfo(float).eps


def factors(a):
    lu, pivots = a.copy(), np.zeros(len(a), np.int64)
    return lu, pivots, lu_factor(lu, pivots)


def rows_exchanged(pivots):
    order = np.arange(len(pivots))
    for k, p in enumerate(pivots):
        order[[k, p]] = order[[p, k]]
    return order


def random_matrix(n, seed, spread):
    rng = np.random.default_rng(seed)
    return (
        10.0 ** rng.uniform(-spread, spread, (n, 1)) * rng.normal(size=(n, n)) * 10.0 ** rng.uniform(-spread, spread, n)
    )


@given(n=st.integers(1, 12), seed=st.integers(0, 10**6), spread=st.sampled_from([0.0, 3.0]))
def test_factors_multiply_to_the_permuted_matrix(n, seed, spread):
    a = random_matrix(n, seed, spread)
    lu, pivots, _ = factors(a)
    lower, upper = np.tril(lu, -1) + np.eye(n), np.triu(lu)
    assert np.abs(lower).max() <= 1.0  # partial pivoting
    miss = np.abs(lower @ upper - a[rows_exchanged(pivots)])
    assert np.all(miss <= n * EPS * (np.abs(lower) @ np.abs(upper)))


@given(n=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_returned_sign_makes_the_determinant(n, seed):
    a = random_matrix(n, seed, 1.0)
    lu, _, sign = factors(a)
    wanted_sign, wanted_log = np.linalg.slogdet(a)
    diagonal = np.diag(lu)
    assert sign * np.prod(np.sign(diagonal)) == wanted_sign
    assert np.sum(np.log(np.abs(diagonal))) == pytest.approx(wanted_log, abs=1e-9 * (1 + abs(wanted_log)))


@given(n=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_solution_is_backward_stable(n, seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(n, n)), rng.normal(size=n)
    lu, pivots, _ = factors(a)
    x = b.copy()
    lu_solve(lu, pivots, x)
    backward = np.abs(a @ x - b).max() / (np.abs(a).sum(axis=1).max() * np.abs(x).max() + np.abs(b).max())
    assert backward < 10 * n * EPS * max(1.0, np.abs(np.triu(lu)).max() / np.abs(a).max())


@pytest.mark.parametrize(
    "a", [np.zeros((2, 2)), np.ones((3, 3)), np.array([[1.0, 2.0], [np.nan, 1.0]]), np.array([[0.0]])], ids=str
)
def test_singular_and_not_a_number_give_sign_zero(a):
    assert factors(np.array(a, dtype=float))[2] == 0
