"""Echelon form of a few vectors, with fractions for its entries."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from contin.abi import Array

ZERO = 1e-7  # entries of null vectors of sampled matrices below this are rounding


def echelon(space: Array, *, relative: bool) -> Array:
    """Reduced row echelon form; entries below `ZERO` (relative: of the largest at the time) are no pivots."""
    rows, done = space.copy(), 0
    for column in range(rows.shape[1]):
        if done == len(rows):
            break
        pivot = done + int(np.argmax(np.abs(rows[done:, column])))
        if abs(rows[pivot, column]) <= ZERO * (np.abs(rows).max() if relative else 1.0):
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        for k in range(len(rows)):
            if k != done:
                rows[k] -= rows[k, column] * rows[done]
        done += 1
    return rows


def fractions(rows: Array, largest: int) -> list[list[Fraction]]:
    """The entries as fractions with denominators up to `largest`."""
    return [[Fraction(float(a)).limit_denominator(largest) for a in row] for row in rows]
