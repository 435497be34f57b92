"""Multilinear forms from derivatives along lines.

    4 B(x, y) = B(x + y, x + y) - B(x - y, x - y),    6 C(x, x, y) = C(x + y, ..) - C(x - y, ..) - 2 C(y, y, y),

which have lines in common, and sums over signs in general. Directions may be complex where derivatives along complex
lines are to be had.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from itertools import product

import numpy as np

from contin.abi import Vector

ALIKE = 0.03  # part of the real one that an imaginary part is at least, and conversely, where forms take both at once

Pure = Callable[[Vector, int], Vector]


def polarised(pure: Pure, directions: Sequence[Vector], reaches: Sequence[float]) -> Vector:
    """D^k F[d1, ..., dk]; pure(v, k) = D^k F[v, ..., v].

    reaches : how far along each direction an unknown changes by its size, so that sums are of vectors alike in size.
    """
    k = len(directions)
    if all(d is directions[0] or np.array_equal(d, directions[0]) for d in directions[1:]):
        return pure(directions[0], k)
    units: dict[bytes, Vector] = {}
    counts: Counter[bytes] = Counter()
    for direction, reach in zip(directions, reaches, strict=True):
        unit = direction * reach
        key = unit.tobytes()
        units[key] = unit
        counts[key] += 1
    whole, own = float(np.prod(reaches)), list(units.values())
    if sorted(counts.values()) == [1, 2]:
        y, x = (units[key] for key in sorted(counts, key=lambda key: counts[key]))
        return np.asarray((pure(x + y, 3) - pure(x - y, 3) - 2.0 * pure(y, 3)) / (6.0 * whole))
    total: Vector = np.zeros(1)
    for weight, multiples in weighted_lines(tuple(counts.values())):
        v = multiples[0] * own[0] + sum(c * d for c, d in zip(multiples[1:], own[1:], strict=True))
        total = total + weight * pure(np.asarray(v), k)
    return total / (2.0 ** (k - 1) * math.factorial(k) * whole)


def are_alike(v: Vector, sizes: Vector) -> bool:
    """Whether v's parts are of like size, or one is zero: else the form of the smaller one would be rounding of the
    other's. Next to a Bogdanov-Takens point the imaginary part is divided by the frequency, which vanishes.
    """
    if not np.iscomplexobj(v):
        return True
    real, imag = (float(np.max(np.abs(part) / sizes)) for part in (v.real, v.imag))
    return min(real, imag) == 0.0 or min(real, imag) > ALIKE * max(real, imag)


@cache
def weighted_lines(counts: tuple[int, ...]) -> tuple[tuple[float, tuple[float, ...]], ...]:
    """Weights and multiples c with 2^(k-1) k! B[d1 .. d1, d2 .. d2, ...] = sum of weight B[v, ..., v], v = sum c_i d_i.

    counts : how often each direction occurs, k times altogether. The sum over all signs of the k directions, of which
    those with the same v are one, v and -v too. (3, 2): 6 for 16.
    """
    found = []
    for minus in product(*(range(count + 1) for count in counts)):
        multiples = tuple(float(count - 2 * less) for count, less in zip(counts, minus, strict=True))
        if next((c for c in multiples if c), -1.0) > 0.0:  # of v and -v one; not v = 0
            ways = math.prod(math.comb(count, less) for count, less in zip(counts, minus, strict=True))
            found.append(((-1.0) ** sum(minus) * ways, multiples))
    return tuple(found)
