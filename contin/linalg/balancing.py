"""Weights of the rows and columns of a matrix that make their sizes alike."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array

SWEEPS: Final = 20


def weights(matrix: Array) -> Array:
    """d (n,) > 0 such that diag(1/d) A diag(d) has rows and columns of like sums of moduli, apart from the diagonal.

    A similarity: the eigenvalues stay, and QR finds them to roundings of the balanced matrix (Osborne, J. ACM 7, 338,
    1960). Rows or columns without entries have weight 1.
    """
    sizes = np.abs(np.asarray(matrix, dtype=float))
    np.fill_diagonal(sizes, 0.0)
    d = np.ones(len(sizes))
    for _ in range(SWEEPS):
        before = d.copy()
        for i in range(len(sizes)):
            column, row = float(sizes[:, i].sum()), float(sizes[i].sum())
            if column > 0.0 and row > 0.0 and np.isfinite(row / column):
                factor = float(np.sqrt(row / column))
                sizes[:, i] *= factor
                sizes[i] /= factor
                d[i] *= factor
        if np.all(np.abs(d - before) <= 0.1 * d):
            break
    return d
