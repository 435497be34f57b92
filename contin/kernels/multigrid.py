"""Half sweeps of Gauss and Seidel's method and products with sparse matrices by rows, for cycles of multigrid.

Matrices are packed: an entry is one number, its upper half the value in units of its row, its lower half the column.
That is half of what must come from memory, which a cycle waits for; a preconditioner needs no more than nine digits.
"""

import numpy as np

from contin.kernels.compile import kernel

COLUMN = 0xFFFFFFFF  # the lower half


@kernel("i1, i1, f1, f1, f1, f1")
def sweep_from_zero(starts, lower, units, inverse, right, x):
    """x = (L + D)^-1 right: a sweep through the rows of L + D + U from x = 0. inverse : of D's entries."""
    for i in range(x.size):
        total = 0.0
        for place in range(starts[i], starts[i + 1]):
            total += float(lower[place] >> 32) * x[np.uint64(lower[place] & COLUMN)]
        x[i] = (right[i] - units[i] * total) * inverse[i]


@kernel("i1, i1, i1, i1, f1, f1, f1, f1")
def sweep_back(lower_starts, lower, upper_starts, upper, units, inverse, right, x):
    """A sweep through the rows from the last to the first, from what x is."""
    for row in range(x.size):
        i = x.size - 1 - row
        total = 0.0
        for place in range(lower_starts[i], lower_starts[i + 1]):
            total += float(lower[place] >> 32) * x[np.uint64(lower[place] & COLUMN)]
        for place in range(upper_starts[i], upper_starts[i + 1]):
            total += float(upper[place] >> 32) * x[np.uint64(upper[place] & COLUMN)]
        x[i] = (right[i] - units[i] * total) * inverse[i]


@kernel("i1, i1, f1, f1, f, f1")
def add_product(starts, entries, units, x, factor, out):
    """out += factor A x"""
    for i in range(out.size):
        total = 0.0
        for place in range(starts[i], starts[i + 1]):
            total += float(entries[place] >> 32) * x[np.uint64(entries[place] & COLUMN)]
        out[i] += factor * units[i] * total
