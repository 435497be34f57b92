"""Sweeps of Gauss and Seidel's method and products with sparse matrices, for cycles of multigrid.

Matrices are packed: an entry is one number, its upper half the value in units of the matrix, its lower half the column
and, at the end of a row, a mark. That is half of what must come from memory, which a cycle waits for; a preconditioner
needs no more than nine digits. Rows from `first` to `last` are independent of each other: whoever calls may share them
among threads, and gets the same digits.
"""

import numpy as np

from contin.kernels.compile import inlined, kernel

COLUMN = 0x7FFFFFFF
END = 0x80000000  # of a row
UNCOLOURED = -1


@inlined("i1, i, f1 -> (f, i)")
def _row_product(entries, place, x):
    """<row, x> in units of the matrix, and the place after the row, which begins at `place`."""
    total = 0.0
    while True:
        entry = entries[np.uint64(place)]
        total += float(entry >> 32) * x[np.uint64(entry & COLUMN)]
        place += 1
        if entry & END:
            return total, place


@kernel("i1, i1, f, f1, f1, i, i")
def relax_rows(starts, entries, unit, right, x, first, last):
    """x_i = right_i - (A x)_i, A without its diagonal of ones."""
    place = starts[first]
    for i in range(np.uint64(first), np.uint64(last)):
        total, place = _row_product(entries, place, x)
        x[i] = right[i] - unit * total


@kernel("i1, i1, i1, i1, f, f1, f1, i, i")
def relax_rows_of_both(lower_starts, lower, upper_starts, upper, unit, right, x, first, last):
    """x_i = right_i - (L x + U x)_i."""
    place, other = lower_starts[first], upper_starts[first]
    for i in range(np.uint64(first), np.uint64(last)):
        below, place = _row_product(lower, place, x)
        above, other = _row_product(upper, other, x)
        x[i] = right[i] - unit * (below + above)


@kernel("i1, i1, f, f1, f1, i, i")
def product_rows(starts, entries, unit, x, out, first, last):
    """out_i = (A x)_i"""
    place = starts[first]
    for i in range(np.uint64(first), np.uint64(last)):
        total, place = _row_product(entries, place, x)
        out[i] = unit * total


@kernel("i1, i1, f, f1, f1, i, i")
def add_product_rows(starts, entries, unit, x, out, first, last):
    """out_i += (A x)_i"""
    place = starts[first]
    for i in range(np.uint64(first), np.uint64(last)):
        total, place = _row_product(entries, place, x)
        out[i] += unit * total


@kernel("i1, f1, f1, f1, i, i")
def gather_scaled(order, scale, x, out, first, last):
    """out_i = scale_i x[order_i]"""
    for i in range(np.uint64(first), np.uint64(last)):
        out[i] = scale[i] * x[np.uint64(order[i])]


@kernel("i1, f1, f1, f1, i, i")
def scatter_scaled(order, scale, x, out, first, last):
    """out[order_i] = scale_i x_i, each place once."""
    for i in range(np.uint64(first), np.uint64(last)):
        out[np.uint64(order[i])] = scale[i] * x[i]


@kernel("i1, i1, i1, i1 -> i")
def colour_rows(starts, columns, taken, colours):
    """Colours (n,) of the rows of a symmetric pattern, the least that no neighbour has; how many there are.

    taken (n + 1,) : memory, of -1.
    """
    count = 0
    colours[:] = UNCOLOURED
    for i in range(colours.size):
        for place in range(starts[i], starts[i + 1]):
            other = colours[columns[place]]
            if other != UNCOLOURED:
                taken[other] = i
        own = 0
        while taken[own] == i:
            own += 1
        colours[i] = own
        count = max(count, own + 1)
    return count
