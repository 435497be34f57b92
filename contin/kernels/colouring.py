"""Colouring of the columns of a sparse matrix so that no two of one colour have a row in common."""

import numpy as np

from contin.kernels.compile import allocating


@allocating("i1, i1, i1, i1, i1 -> i")
def colour_columns(pointers, rows, row_pointers, row_columns, colours):
    """Greedy colouring (Curtis, Powell and Reid 1974) in the given order; returns the number of colours.

    pointers, rows : CSC pattern.  row_pointers, row_columns : the same in CSR.  colours : (n,), filled.
    """
    n = colours.size
    colours[:] = -1
    taken = np.full(n + 1, -1, np.int64)  # taken[c] = j: colour c is used by a neighbour of column j
    count = 0
    for j in range(n):
        for a in range(pointers[j], pointers[j + 1]):
            i = rows[a]
            for b in range(row_pointers[i], row_pointers[i + 1]):
                c = colours[row_columns[b]]
                if c >= 0:
                    taken[c] = j
        c = 0
        while taken[c] == j:
            c += 1
        colours[j] = c
        count = max(count, c + 1)
    return count
