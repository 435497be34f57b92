"""The unknowns in which the inside of a mesh interval is eliminated: the values at its Gauss points (stage values).

A piece of the solution is the polynomial through its value u_0 at the left end and the values v_1 .. v_m at the Gauss
points. In these unknowns the linearised collocation equations of an interval of length h are

    D_c0 u_0 + sum_d D_cd v_d - h T J_c v_c + (columns of T and p) = r_c,      c = 1 .. m,

D (m, m + 1) the derivatives of the Lagrange polynomials: only the diagonal blocks hold a Jacobian, all others are
multiples of the identity. So once the inverse Z (2 n, 2 n) of the outer pair, the first and the last stage, is known,
what eliminating them leaves for the others is a linear combination of its four blocks, no product of matrices. The
other stages go by elimination with pivots; the right end is u_1 = E (u_0, v) with the extrapolation E, so that its
block is the identity and that of u_0 minus the transition matrix. For m = 4 and large n that takes 0.6 of the
operations of an elimination of the values at the inner nodes, and only the Jacobians have to be filled in.

The blocks of the pair off the diagonal are multiples y, z of the identity, so that with A and D on it, all n x n,

    S = D - y z A^-1,   Z = [ A^-1 + y z A^-1 S^-1 A^-1,  -y A^-1 S^-1;  -z S^-1 A^-1,  S^-1 ]

takes two inverses and three products, 10 n^3 operations and not 16 n^3. Where A^-1 is large beside 1/y or 1/z rounding
would grow (h T times an eigenvalue near that of A): there Z comes from an inversion of the pair with pivots from both.

The outer pair, because the eigenvalues of its block of D are the farthest from 0 (m = 4: 7.74 +- 1.16 i): Z is missing
only where h T times an eigenvalue of the Jacobian meets them, growth by e^7 within one interval.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np

from contin.kernels.collocation_basis import basis
from contin.kernels.compile import kernel
from contin.kernels.signature import structure

GROWTH = 10.0  # of rounding errors that is let be, as where a pivot is a tenth of the largest candidate
ALIKE = 1e3  # sizes of states that differ by less, and from 1, count as 1: pivots are good with numbers as they stand

Stages = namedtuple(
    "Stages",
    [
        # With n <= LANES the axis of the N intervals is the last one, beyond the first one, as in `Factors`.
        "nodes",  # (m + 1, m + 1): values at the nodes from (u_0, v)
        "differences",  # (m, m + 1): D
        "columns",  # (2, m n, N) coefficients of T and p at the Gauss points
        "borders",  # (2, m + 1, n, N) the border rows' coefficients of (u_0, v)
        "pivots",  # (2 n, N)
        "inverse",  # (2 n, 2 n, N) Z
        "first",  # (n, n, N or 1) memory: of the first stage alone
        "last",  # ... and of the last one, without the first
        "timing",  # (2, 2 n, N) Z times the pair's rows of `columns`
        "product",  # (2 n, n or N) memory
        "outer",  # (2 n, N) Z times the pair's right-hand sides
        "values",  # (m n, N) stage values of a solution
        "vector",  # (2, max(2, m) n) memory
        "weights",  # (m n + 4,) of rows where pivots are chosen: 1 / the size of the row's state
        "row_weights",  # (m n + 4, N) memory: they are exchanged with their rows
    ],
)
structure(Stages, "f2, f2, f3, f4, i2, f3, f3, f3, f3, f2, f2, f2, f2, f1, f2")


@kernel("f1, i, f1")
def weigh(weights, n, sizes):
    """1 / sizes of the n states, one stage after another; all 1 where sizes are those of ordinary units.

    A pivot is the largest in its column of rows that are measured in the sizes of their states. In units of 1e8 and
    1e-8 the largest number would be a wrong pivot, and rounding errors as large as the solution.
    """
    low, high = np.inf, 0.0
    for k in range(n):
        low = min(low, sizes[k])
        high = max(high, sizes[k])
    ordinary = low * ALIKE >= max(1.0, high) and high <= ALIKE
    known = low > 0.0 and high < np.inf
    for r in range(weights.size):
        weights[r] = 1.0 / sizes[r % n] if known and not ordinary else 1.0


def new_stages(n: int, m: int, intervals: int, dense: bool) -> Stages:
    """Memory for one matrix."""
    scheme = basis(m)
    nodes = np.linalg.inv(np.vstack([np.eye(1, m + 1), scheme.values]))

    def lanes(*shape: int) -> np.ndarray:
        return np.zeros((intervals, *shape) if dense else (*shape, intervals))

    pivots = (intervals, 2 * n) if dense else (2 * n, intervals)
    half = (1, n, n) if dense else (n, n, intervals)
    return Stages(
        nodes, scheme.slopes @ nodes, lanes(2, m * n), lanes(2, m + 1, n),
        np.zeros(pivots, np.int64), lanes(2 * n, 2 * n), np.zeros(half), np.zeros(half), lanes(2, 2 * n),
        np.zeros((2 * n, n if dense else intervals)), np.zeros((2 * n, intervals)), np.zeros((m * n, intervals)),
        np.zeros((2, max(2, m) * n)), np.ones(max(2, m) * n + 4), np.ones((max(2, m) * n + 4, intervals)),
    )  # fmt: skip
