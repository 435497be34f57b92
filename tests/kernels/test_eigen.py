"""Eigenvalues against numpy and closed forms: random, graded, defective matrices, and warm starts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contin.kernels.eigen import balance, eigenvalues

EPS = np.finfo(float).eps


def ours(a, near=None):
    n = len(a)
    re, im = np.full(n, np.nan), np.full(n, np.nan)
    if near is None:
        near = re, im
    assert eigenvalues(np.array(a, dtype=float), re, im, near[0].copy(), near[1].copy()) == 0
    return re, im


def distance(found, wanted):
    """Largest distance in the best pairing of two sets of complex numbers."""
    from scipy.optimize import linear_sum_assignment

    cost = np.abs(np.asarray(found)[:, None] - np.asarray(wanted)[None, :])
    i, j = linear_sum_assignment(cost)
    return cost[i, j].max()


def as_complex(pair):
    return pair[0] + 1j * pair[1]


@given(n=st.integers(1, 14), seed=st.integers(0, 10**6))
def test_eigenvalues_of_random_matrices_agree_with_lapack(n, seed):
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(n, n))
    values, vectors = np.linalg.eig(a)
    tolerance = 100 * n * EPS * np.linalg.norm(a) * np.linalg.cond(vectors)  # Bauer and Fike
    assert distance(as_complex(ours(a)), values) < tolerance


@given(n=st.integers(2, 12), seed=st.integers(0, 10**6))
def test_known_spectrum_survives_an_orthogonal_similarity(n, seed):
    """A normal matrix: eigenvalues are perfectly conditioned, so they come back to rounding."""
    rng = np.random.default_rng(seed)
    blocks = np.zeros((n, n))
    wanted, k = [], 0
    while k < n:
        if k + 1 < n and rng.random() < 0.5:
            x, y = rng.normal(size=2)
            blocks[k : k + 2, k : k + 2] = [[x, -y], [y, x]]
            wanted += [x + 1j * y, x - 1j * y]
            k += 2
        else:
            blocks[k, k] = rng.normal()
            wanted.append(blocks[k, k])
            k += 1
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    assert distance(as_complex(ours(q @ blocks @ q.T)), wanted) < 1e-12


@given(seed=st.integers(0, 10**6), n=st.integers(2, 8), units=st.integers(1, 12))
def test_change_of_units_of_the_states_changes_no_eigenvalue(seed, n, units):
    rng = np.random.default_rng(seed)
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    a = q @ np.diag(rng.permutation(n) + 1.0) @ q.T
    d = 10.0 ** rng.uniform(-units, units, n)
    assert distance(as_complex(ours(a * d / d[:, None])), np.arange(n) + 1.0) < 1e-9


def test_eigenvalues_of_a_triangular_matrix_over_forty_orders_of_magnitude_are_its_diagonal():
    diagonal = 10.0 ** np.arange(-20.0, 21.0, 5.0)
    a = np.diag(diagonal) + np.triu(np.ones((9, 9)), 1) * 1e-3 * np.minimum.outer(diagonal, diagonal)
    re, im = ours(a)
    np.testing.assert_allclose(np.sort(re), diagonal, rtol=1e-12)
    assert not im.any()


def test_graded_blocks_whose_squares_underflow_do_not_hide_the_large_eigenvalues():
    """Rows fall off as multipliers of a dissipative PDE do: pairs at 1e-163 and 1e-172 beside 210.5 and -.116."""
    sizes = np.array([210.5, 0.116, 1e-98, 1e-98, 1e-163, 1e-163, 1e-172, 1e-172])
    rng = np.random.default_rng(3)
    for _ in range(20):
        a = sizes[:, None] * rng.normal(size=(8, 8))
        re, im = ours(a)
        assert np.all(np.isfinite(re))
        two = np.sort(np.linalg.eigvals(a[:2, :2].copy()))  # the rest changes them by 1e-98
        largest = np.sort((re + 1j * im)[np.argsort(-np.abs(re + 1j * im))[:2]])
        np.testing.assert_allclose(largest, two, rtol=1e-12)


@pytest.mark.parametrize("n", [2, 3, 5, 8])
def test_jordan_block_splits_by_no_more_than_the_root_of_rounding(n):
    rng = np.random.default_rng(n)
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    a = q @ (2.0 * np.eye(n) + np.diag(np.ones(n - 1), 1)) @ q.T
    assert distance(as_complex(ours(a)), np.full(n, 2.0)) < 4 * (10 * EPS) ** (1 / n)


@pytest.mark.parametrize("n", [3, 4, 7])
def test_companion_matrix_of_roots_of_unity(n):
    """A cyclic permutation: plain shifted QR stands still on it; exceptional shifts are needed."""
    a = np.roll(np.eye(n), 1, axis=0)
    assert distance(as_complex(ours(a)), np.exp(2j * np.pi * np.arange(n) / n)) < 1e-12


@pytest.mark.parametrize("a", [np.zeros((3, 3)), np.eye(4), np.diag([1.0, 1.0, -1.0]), np.ones((5, 5))], ids=str)
def test_multiple_eigenvalues_of_symmetric_matrices(a):
    assert distance(as_complex(ours(a)), np.linalg.eigvalsh(a)) < 1e-14 * max(1.0, np.abs(a).sum())


@given(n=st.integers(3, 10), seed=st.integers(0, 10**6), change=st.floats(-12, 1))
def test_warm_start_changes_speed_not_the_answer(n, seed, change):
    """From eigenvalues of a nearby, or of an unrelated, matrix the same ones are found to rounding."""
    rng = np.random.default_rng(seed)
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    a = q @ np.diag(rng.normal(size=n)) @ q.T
    turned = rng.normal(size=(n, n))
    a = a + (turned - turned.T)  # symmetric plus antisymmetric: real and complex eigenvalues, mildly conditioned
    near = ours(a + 10.0**change * rng.normal(size=(n, n)))
    values, vectors = np.linalg.eig(a)
    tolerance = 100 * n * EPS * np.linalg.norm(a) * np.linalg.cond(vectors)
    assert distance(as_complex(ours(a, near)), values) < tolerance


@given(n=st.integers(1, 10), seed=st.integers(0, 10**6))
def test_conjugate_pairs_are_neighbours_with_the_positive_imaginary_part_first(n, seed):
    re, im = ours(np.random.default_rng(seed).normal(size=(n, n)))
    k = 0
    while k < n:
        if im[k] == 0.0:
            k += 1
            continue
        assert im[k] > 0.0
        assert (re[k + 1], im[k + 1]) == (re[k], -im[k])
        k += 2


def test_not_finite_matrix_is_reported_not_looped_over():
    a = np.eye(3)
    a[1, 1] = np.nan
    re, im = np.zeros(3), np.zeros(3)
    assert eigenvalues(a, re, im, re.copy(), im.copy()) == 1
    assert np.isnan(re).all()


def test_balancing_is_a_similarity_by_powers_of_two():
    rng = np.random.default_rng(5)
    d = 10.0 ** rng.uniform(-8, 8, 6)
    a = rng.normal(size=(6, 6)) * d / d[:, None]
    b = a.copy()
    balance(b)
    ratio = (b / a)[0]  # b_0j / a_0j = d_j / d_0
    np.testing.assert_array_equal(np.log2(np.abs(ratio)), np.round(np.log2(np.abs(ratio))))
    np.testing.assert_array_equal(b, a * ratio / ratio[:, None])
    norms = np.abs(b).sum(axis=0) / np.abs(b).sum(axis=1)
    assert norms.max() < 4.0
    assert norms.min() > 0.25
