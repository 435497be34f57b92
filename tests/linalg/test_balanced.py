"""Factors of balanced matrices: as accurate as the matrix in its best units, whatever the units it is given in."""

import numpy as np
import pytest
from scipy import sparse

from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear

N = 60


def badly_scaled(seed: int):
    """A singular sparse matrix, one border and the solution of the bordered system, in units 1e-15 to 1e15."""
    generator = np.random.default_rng(seed)
    a = np.where(generator.uniform(size=(N, N)) < 0.08, generator.normal(size=(N, N)), 0.0) + 3.0 * np.eye(N)
    u, s, v = np.linalg.svd(a)
    b, c = u[:, -1], v[-1]
    a = a - s[-1] * np.outer(b, c)
    x = generator.normal(size=N + 1)
    rows, columns = 10.0 ** generator.uniform(-15, 15, N), 10.0 ** generator.uniform(-15, 15, N)
    right = np.append(rows * (a @ x[:N] + b * x[N]), c @ x[:N])
    matrix = sparse.csc_matrix(rows[:, None] * a * columns)
    matrix.sort_indices()
    return matrix, rows * b, c * columns, right, np.append(x[:N] / columns, x[N])


@pytest.mark.parametrize("seed", range(5))
def test_a_bordered_singular_matrix_in_odd_units_is_solved_to_rounding(seed):
    matrix, b, c, right, expected = badly_scaled(seed)
    linear = DirectLinear(matrix, Factoriser(), balanced=True)
    found = linear.bordered(b[:, None], c[:, None], np.zeros((1, 1))).solve(right)
    np.testing.assert_allclose(found / expected, 1.0, atol=1e-9)


def test_the_transpose_and_the_sign_are_those_of_the_matrix():
    matrix = sparse.csc_matrix(np.array([[0.0, 1e-12], [1e9, 3e-12]]))
    factor = DirectLinear(matrix, Factoriser(), balanced=True).factor
    assert factor.sign == -1.0
    np.testing.assert_allclose(factor.solve_transposed(np.array([1e9, 5e-12])), [2.0, 1.0], rtol=1e-12)
    np.testing.assert_allclose(factor.solve(np.array([2e-12, 1e9 + 6e-12])), [1.0, 2.0], rtol=1e-12)


def test_several_right_hand_sides_are_solved_as_one_after_the_other():
    for seed, dense in ((0, True), (1, False)):
        matrix = badly_scaled(seed)[0]
        if not dense:  # a band
            matrix = sparse.csc_matrix(sparse.tril(sparse.triu(matrix + sparse.identity(N), -2), 3))
        factor = DirectLinear(matrix, Factoriser(), balanced=True).factor
        right = np.random.default_rng(seed).normal(size=(N, 3))
        for solve in (factor.solve, factor.solve_transposed):
            found = solve(right)
            assert found.shape == right.shape
            for one, column in zip(found.T, right.T, strict=True):
                alone = solve(column)
                np.testing.assert_allclose(one, alone, rtol=1e-6, atol=1e-12 * np.abs(alone).max())


def test_the_places_of_entries_are_looked_for_once_a_pattern(monkeypatch):
    matrix = badly_scaled(2)[0]
    factoriser, seen, argsort = Factoriser(), [], np.argsort

    def counted(*arguments, **options):
        seen.extend([options] if options.get("kind") == "stable" else [])
        return argsort(*arguments, **options)

    monkeypatch.setattr(np, "argsort", counted)
    for factor in (1.0, 2.0, 3.0):
        other = DirectLinear(factor * matrix, factoriser, balanced=True).factor
        assert np.isfinite(other.solve(np.ones(N))).all()
    assert len(seen) == 1
    other = DirectLinear(sparse.csc_matrix(2.0 * np.eye(N)), factoriser, balanced=True).factor
    np.testing.assert_array_equal(other.solve(np.ones(N)), 0.5 * np.ones(N))
    assert len(seen) == 2  # another pattern
