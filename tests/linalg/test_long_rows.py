"""Products, combinations and orthonormal bases of a few long rows; how far a sparse matrix is symmetric."""

import numpy as np
import pytest
import scipy.sparse as sp

from contin.linalg.eigen import Region
from contin.linalg.orthonormal import orthonormal, outside
from contin.linalg.vectors import (
    added_and_multiplied,
    combination,
    dot,
    inner,
    mixed,
    norm,
    norm_in_units,
    plus_combined,
    products,
)
from contin.machine.threads import PART


@pytest.mark.parametrize("n", [1, 511, 512, 513, 3000])
def test_products_and_combinations_are_those_of_matrices(n):
    generator = np.random.default_rng(n)
    a, b, weights = generator.normal(size=(3, n)), generator.normal(size=(5, n)), generator.normal(size=(2, 5))
    np.testing.assert_allclose(inner(a, b), a @ b.T, atol=1e-13 * n)
    np.testing.assert_allclose(mixed(weights, b), weights @ b, atol=1e-14)
    added = a[:2].copy()
    assert mixed(weights, b, added_to=added) is added
    np.testing.assert_allclose(added, a[:2] + weights @ b, atol=1e-14)


@pytest.mark.parametrize("n", [1000, PART + 1, 3 * PART])
def test_long_vectors_are_summed_and_combined_as_short_ones(n):
    generator = np.random.default_rng(n)
    a, b, weights = generator.normal(size=n), generator.normal(size=n), generator.normal(size=3)
    rows = np.linalg.qr(generator.normal(size=(n, 3)))[0].T.copy()
    assert dot(a, b) == pytest.approx(a @ b, abs=1e-13 * n)
    assert norm(a) == pytest.approx(np.linalg.norm(a), rel=1e-14)
    assert norm_in_units(a, np.abs(b) + 1.0) == pytest.approx(np.linalg.norm(a / (np.abs(b) + 1.0)), rel=1e-14)
    np.testing.assert_allclose(combination(weights, list(rows)), weights @ rows, atol=1e-15)
    moved = a + weights @ rows
    longer = np.full(n + 1, 7.0)
    plus_combined(a, rows[0][:, None], weights[:1], longer)
    np.testing.assert_allclose(longer, np.append(a + weights[0] * rows[0], 7.0), atol=1e-15)
    np.testing.assert_allclose(products(rows[0][:, None], a), [rows[0] @ a], atol=1e-13 * n)
    told = added_and_multiplied(weights, rows, a)
    np.testing.assert_allclose(a, moved, atol=1e-14)
    np.testing.assert_allclose(told, np.append(rows @ moved, moved @ moved), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("angle", [1.0, 1e-2, 1e-5])
def test_rows_become_orthonormal_at_any_angle_to_each_other_and_to_a_basis(angle):
    generator = np.random.default_rng(3)
    n = 2000
    basis = np.linalg.qr(generator.normal(size=(n, 3)))[0].T.copy()
    rows = generator.normal(size=(1, n)) + angle * generator.normal(size=(3, n))
    rows += generator.normal(size=(3, 3)) @ basis
    rows *= np.array([[1e-30], [1.0], [1e30]])
    found = orthonormal(rows, basis)
    both = np.vstack([basis, found])
    np.testing.assert_allclose(both @ both.T, np.eye(6), atol=1e-13)
    left = outside(rows / np.linalg.norm(rows, axis=1)[:, None], both)
    assert np.abs(left).max() < 1e-15 / angle + 1e-14


def test_rows_that_depend_on_each_other_or_on_a_basis_are_left_out():
    generator = np.random.default_rng(4)
    rows = generator.normal(size=(3, 500))
    rows[2] = rows[0] - 2.0 * rows[1]
    found = orthonormal(np.vstack([rows, np.zeros((1, 500))]))
    np.testing.assert_allclose(found @ found.T, np.eye(2), atol=1e-13)
    assert len(orthonormal(rows, found)) == 0


@pytest.mark.parametrize("skew", [0.0, 0.3])
def test_the_region_of_unstable_eigenvalues_is_that_of_the_symmetric_and_the_skew_part(skew):
    generator = np.random.default_rng(5)
    half = sp.random(60, 60, 0.1, random_state=1, data_rvs=lambda size: generator.normal(size=size)).tocsc()
    matrix = (half + half.T + skew * (half - half.T) + sp.diags(generator.normal(size=60))).tocsc()
    matrix.sort_indices()
    region = Region()
    for factor in (1.0, 2.0):  # of one pattern
        assert region.of(factor * matrix) == pytest.approx(Region.of_any(factor * matrix), rel=1e-13, abs=1e-13)
