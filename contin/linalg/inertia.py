"""How many eigenvalues of a symmetric matrix are positive: Sylvester's law of inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


def positive_eigenvalues(matrix: csc_matrix) -> int | None:
    """The count, from the signs of the pivots of an elimination along the diagonal: A = L D L^T.

    None where a pivot is too small for that, so that the elimination leaves the diagonal. Costs one set of factors.
    """
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:  # exactly singular
        return None
    if not np.array_equal(factors.perm_r, factors.perm_c):
        return None
    return int(np.count_nonzero(factors.U.diagonal() > 0.0))
