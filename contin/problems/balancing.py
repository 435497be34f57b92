"""Units in which the rows and columns of a matrix have like norms."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RADIX: Final = 2.0  # scaling by its powers rounds nothing
WORTH: Final = 0.95  # a step that lowers the sum of the two norms by less is not made
SMALLEST: Final = float(np.finfo(float).tiny / np.finfo(float).eps)
LARGEST: Final = 1.0 / SMALLEST


def balancing_scales(matrix: Array) -> Array:
    """Powers of two d, (n,), so that row and column k of diag(1/d) matrix diag(d) have like 2-norms, for every k.

    The criterion is that of LAPACK's dgebal since 3.5.0 (James, Langou and Lowery, On matrix balancing and eigenvector
    computation, arXiv:1401.5766), after Parlett and Reinsch, Numer. Math. 13 (1969) 293. A row or column of zeros is
    left alone. Python's arithmetic: O(n) calls a sweep, a few sweeps; scipy's, of the same result, costs the import of
    a library.
    """
    a = np.array(matrix, dtype=float)
    n = len(a)
    scales = np.ones(n)
    going = bool(np.all(np.isfinite(a)))
    while going:
        going = False
        for k in range(n):
            column, row = _norm(a[:, k]), _norm(a[k])
            if column == 0.0 or row == 0.0:
                continue
            factor = _factor(column, row, float(np.max(np.abs(a[:, k]))), float(np.max(np.abs(a[k]))))
            if column * factor + row / factor >= WORTH * (column + row):
                continue
            if not SMALLEST < factor * scales[k] < LARGEST:
                continue
            scales[k] *= factor
            a[k] /= factor
            a[:, k] *= factor
            going = True
    return scales


def _factor(column: float, row: float, column_entry: float, row_entry: float) -> float:
    """The power of two f for which f times the column and the row divided by f are nearest."""
    smallest, largest = SMALLEST * RADIX, LARGEST / RADIX
    factor = 1.0
    while column < row / RADIX and max(factor, column, column_entry) < largest and min(row, row_entry) > smallest:
        factor, column, column_entry = factor * RADIX, column * RADIX, column_entry * RADIX
        row, row_entry = row / RADIX, row_entry / RADIX
    while column / RADIX >= row and max(row, row_entry) < largest and min(factor, column, column_entry) > smallest:
        factor, column, column_entry = factor / RADIX, column / RADIX, column_entry / RADIX
        row, row_entry = row * RADIX, row_entry * RADIX
    return factor


def _norm(x: Array) -> float:
    largest = float(np.max(np.abs(x)))
    if largest == 0.0:
        return 0.0
    y = x / largest
    return largest * float(np.sqrt(np.sum(y * y)))
