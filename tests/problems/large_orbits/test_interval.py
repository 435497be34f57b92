"""Patterns of the Jacobians along an orbit."""

import numpy as np
from scipy import sparse

from contin.problems.large_orbits.interval import full_diagonals


def test_diagonals_are_filled_whatever_pattern_or_format_comes_next():
    full = np.array([[1.0, 2.0], [3.0, 4.0]])
    some = [full, 2.0 * full, np.array([[0.0, 5.0], [6.0, 7.0]]), np.array([[0.0, 8.0], [9.0, 1.0]]), full]
    given = [sparse.csc_matrix(J) for J in some]
    given.insert(1, sparse.csr_matrix(full))  # its rows are stored as columns of the one before are
    for J, made in zip([some[0], full, *some[1:]], full_diagonals(given), strict=True):
        np.testing.assert_array_equal(made.toarray(), J)
        assert made.format == "csc"
        assert made.nnz == 4
