"""Equal bistable cells, all coupled alike, x_i' = p + q x_i - x_i^3 + k sum_j (x_j - x_i): every equilibrium, exactly.

Two cells differ only if x^2 + x y + y^2 = q - n k; with three cells the equilibria are n equal states, two alike
beside one (roots of a polynomial of degree six), or three roots of x^3 - (q - 3 k) x = p, whose sum is zero. At
all cells alike the symmetry makes kernels of dimension two.
"""

from __future__ import annotations

from collections import Counter
from itertools import permutations

import numpy as np

import contin

COUPLING = 0.05
REAL = 1e-7  # imaginary parts below this are rounding errors: the points are chosen away from folds
SYMMETRIES = {"swap": {"x1": "x2", "x2": "x1"}, "turn": {"x1": "x2", "x2": "x3", "x3": "x1"}}


def three_cells() -> contin.Model:
    """The model, with symmetries that generate all six permutations by products of up to three."""
    names = ("x1", "x2", "x3")
    equations = {x: f"p + q*{x} - {x}^3 + k*(x1 + x2 + x3 - 3*{x})" for x in names}
    return contin.Model(
        "cells", states=dict.fromkeys(names, 0.0), parameters={"p": 0.0, "q": -1.0, "k": COUPLING},
        equations=equations, symmetries=SYMMETRIES,
    )  # fmt: skip


def equilibria(p: float, q: float, k: float = COUPLING) -> list[tuple[float, float, float]]:
    """All of them."""
    m = q - 3.0 * k
    found = [(x.real, x.real, x.real) for x in np.roots([-1.0, 0.0, q, p]) if abs(x.imag) < REAL]
    x = np.poly1d([1.0, 0.0])
    y = (x**3 - m * x - p) / k - 2.0 * x  # the third cell, where two are x
    for root in (x * x + x * y + y * y - m).roots:
        a, b = root.real, y(root.real)
        if abs(root.imag) < REAL and abs(a - b) > 1e-5:
            found += [(a, a, b), (a, b, a), (b, a, a)]
    roots = np.roots([1.0, 0.0, -m, -p])
    if np.all(np.abs(roots.imag) < REAL):
        found += list(permutations(roots.real.tolist()))
    return found


def unstable(u: tuple[float, ...], q: float, k: float = COUPLING) -> int:
    """How many eigenvalues of the Jacobian at u are positive."""
    n = len(u)
    matrix = np.diag(q - 3.0 * np.square(u) - n * k) + k
    return int(np.sum(np.linalg.eigvalsh(matrix) > 0.0))


def census(p: float, q: float) -> Counter[int]:
    """How many equilibria have so many unstable eigenvalues."""
    return Counter(unstable(u, q) for u in equilibria(p, q))
