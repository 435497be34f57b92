"""Units in which the rows and columns of a matrix have like norms."""

from __future__ import annotations

from math import sqrt
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
    left alone. On Python's numbers: arrays this small would cost more; scipy's, of the same result, costs the import
    of a library.
    """
    n, scales = len(matrix), [1.0] * len(matrix)
    a: list[list[float]] = np.asarray(matrix, dtype=float).tolist()
    going = bool(np.isfinite(matrix).all())
    while going:
        going = False
        for k in range(n):
            down, across = [abs(row[k]) for row in a], [abs(x) for x in a[k]]
            column, line = _norm(down), _norm(across)
            if column == 0.0 or line == 0.0:
                continue
            factor = _factor(column, line, max(down), max(across))
            if column * factor + line / factor >= WORTH * (column + line):
                continue
            if not SMALLEST < factor * scales[k] < LARGEST:
                continue
            scales[k] *= factor
            a[k] = [x / factor for x in a[k]]
            for row in a:
                row[k] *= factor
            going = True
    return np.array(scales)


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


def _norm(sizes: list[float]) -> float:
    """The 2-norm of numbers with these moduli."""
    largest = max(sizes)
    if largest == 0.0:
        return 0.0
    return largest * sqrt(sum((x / largest) * (x / largest) for x in sizes))
