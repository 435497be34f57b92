"""Dense rows and columns beside a sparse matrix, against the same put together densely."""

import numpy as np
from scipy import sparse

from contin.linalg.csc import with_columns, with_rows


def some(rng, n, m):
    dense = rng.normal(size=(n, m)) * (rng.random((n, m)) < 0.3)
    return dense, sparse.csc_matrix(dense)


def test_rows_and_columns_stand_where_they_are_put():
    rng = np.random.default_rng(3)
    for n, m, k in ((1, 1, 1), (5, 4, 2), (7, 9, 3), (30, 31, 1)):
        dense, matrix = some(rng, n, m)
        columns = rng.normal(size=(n, k)) * (rng.random((n, k)) < 0.7)
        rows = rng.normal(size=(k, m)) * (rng.random((k, m)) < 0.7)
        for place in range(m + 1):
            wide = with_columns(matrix, columns, place)
            assert np.array_equal(wide.toarray(), np.hstack([dense[:, :place], columns, dense[:, place:]]))
            assert wide.has_canonical_format
        tall = with_rows(matrix, rows)
        assert np.array_equal(tall.toarray(), np.vstack([dense, rows]))
        assert tall.has_canonical_format
        assert tall.nnz == matrix.nnz + np.count_nonzero(rows)  # zeros are not stored


def test_a_matrix_is_bordered_on_both_sides():
    rng = np.random.default_rng(4)
    dense, matrix = some(rng, 6, 6)
    left, right = rng.normal(size=(6, 1)), rng.normal(size=(1, 6))
    whole = with_rows(with_columns(matrix, left), np.hstack([right, np.zeros((1, 1))]))
    assert np.array_equal(whole.toarray(), np.block([[dense, left], [right, np.zeros((1, 1))]]))
