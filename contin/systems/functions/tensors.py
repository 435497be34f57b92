"""All derivatives of order 2 or 3 of a function of few states at a point, from pure ones along sums of axes.

With q(v) = D^k F[v, .., v] and axes a, b, c in the states' own sizes,

    2 D^2 F[a, b] = q(a + b) - q(a) - q(b),
    6 D^3 F[a, a, b] = q(a + b) - q(a - b) - 2 q(b),    6 D^3 F[a, b, c] = q(a + b + c) - (what has fewer axes),

so that n (n + 1)/2 and n (n + 1)(n + 2)/6 pure derivatives give every form there, complex directions too.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, permutations

import numpy as np

from contin.abi import Array, Vector

Pure = Callable[[Array], Array]


def second(pure: Pure, n: int) -> Array:
    """D^2 F (n, n, n): of two axes, then components; pure(v) = D^2 F[v, v] for v (n,) in axes."""
    axes = np.eye(n)
    own = [pure(a) for a in axes]
    found = np.zeros((n, n, n))
    for i in range(n):
        found[i, i] = own[i]
    for i, j in combinations(range(n), 2):
        found[i, j] = found[j, i] = 0.5 * (pure(axes[i] + axes[j]) - own[i] - own[j])
    return found


def third(pure: Pure, n: int) -> Array:
    """D^3 F (n, n, n, n): of three axes, then components; pure(v) = D^3 F[v, v, v]."""
    axes = np.eye(n)
    own = [pure(a) for a in axes]
    found = np.zeros((n, n, n, n))
    for i in range(n):
        found[i, i, i] = own[i]
    for i, j in combinations(range(n), 2):
        plus, minus = pure(axes[i] + axes[j]), pure(axes[i] - axes[j])
        _enter(found, (i, i, j), (plus - minus - 2.0 * own[j]) / 6.0)
        _enter(found, (i, j, j), (plus + minus - 2.0 * own[i]) / 6.0)
    for chosen in combinations(range(n), 3):
        rest = sum(own[i] for i in chosen)
        for i, j in permutations(chosen, 2):
            rest = rest + 3.0 * found[i, i, j]
        _enter(found, chosen, (pure(sum(axes[i] for i in chosen)) - rest) / 6.0)
    return found


def _enter(found: Array, place: tuple[int, ...], value: Array) -> None:
    for each in set(permutations(place)):
        found[each] = value


def contracted(tensor: Array, directions: tuple[Vector, ...]) -> Vector:
    """The form (n,) along so many directions (n,)."""
    result: Vector = tensor
    for direction in directions:
        result = np.tensordot(direction, result, axes=1)
    return result
