"""Copies of multiple eigenvalues that rounding made complex pairs."""

import numpy as np

from contin.linalg.copies import _split, with_copies
from contin.linalg.eigen import Spectrum


def test_a_double_eigenvalue_that_rounding_made_a_pair_keeps_both_its_vectors():
    """x +- i y to 0.3 +- 1e-16 i: any two vectors of the plane of x and y are eigenvectors, and none is zero."""
    x, y, z, w = np.eye(5)[:4] + 0.1
    values = np.array([0.3 + 1e-16j, 0.3 - 1e-16j, 0.3, 0.3 + 2e-16j, 0.3 - 2e-16j, -1.0])
    vectors = np.column_stack([x + 1j * y, x - 1j * y, z, w + 1j * np.eye(5)[4], w - 1j * np.eye(5)[4], x])
    found = _split(values, vectors, True, 1e-16)
    assert np.all(found.values.imag == 0.0)
    assert np.all(found.vectors.imag == 0.0)
    assert np.linalg.matrix_rank(found.vectors[:, :5].real) == 5


def test_a_pair_is_left_as_it_is_where_it_is_one():
    values = np.array([1j, -1j])
    vectors = np.array([[1.0, 1.0], [1j, -1j]])
    found = _split(values, vectors, True, 1e-16)
    np.testing.assert_array_equal(found.values, values)
    np.testing.assert_array_equal(found.vectors, vectors)


class Diagonal:
    """diag(d), as Arnoldi's method takes it."""

    def __init__(self, d):
        self.d = d

    def solve(self, right, tolerance=0.0):
        return right / self.d

    def weigh(self, x):
        return x

    def magnitude(self, x):
        return np.abs(self.d) * np.abs(x)


def test_where_no_eigenvalue_was_found_all_near_zero_are_looked_for():
    """Nothing is projected out at first: 0.5 three times, and 3."""
    none = Spectrum(np.empty(0, complex), np.empty((6, 0), complex), False)
    found = with_copies(Diagonal(np.array([0.5, 0.5, 0.5, 3.0, 4.0, 5.0])), 6, none, 1.0)
    np.testing.assert_allclose(np.sort(found.values.real)[:3], 0.5, rtol=1e-12)
