"""Defining systems of special points, F = 0 and a matrix bordered to a regular one, at many places in one call.

[B b; c^* 0] [V; g] = [0; I]: B is singular where g vanishes, and with the row w^* of the inverse that belongs to g the
derivative is dg = -w^* (dB) V (Govaerts 2000). In scaled unknowns y = z / D, z = (u, p), with rows divided by `rows`:

    FOLD    B = F_u - shift I, one real g               BRANCH  B = [F_u F_p], two real g
    PAIR    B = F_u - s(w) I, one complex g; the last unknown is w in `unit`; s = i w of flows, exp(i w) - 1 of maps

I becomes diag(identity) where equations are divided by their rates. Complex systems are solved as real ones of twice
the size, [Re -Im; Im Re].
"""

import math

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.compile import call4, call5, kernel
from contin.kernels.dense import lu_factor, lu_solve

FOLD, BRANCH, PAIR = range(3)
Z, IMAGE, DIRECTION, V, _, W, _ = range(7)
"""Rows of `vectors`: z, what functions return, a direction, V (two rows: of BRANCH both, of PAIR its real and
imaginary part), w (its real and imaginary part, or 0)."""


def memory(n: int, p_size: int, kind: int) -> tuple[Array, Array, Array, Array, NDArray[np.int64]]:
    """Arrays that `evaluate` works in, for n equations with so many parameters: its last arguments.

    vectors (7, .), jacobian (n, n + p_size), scaled (n, n + 1), bordered (k, k), pivots (k,), k the size of the
    bordered matrix in real numbers.
    """
    size = {FOLD: n + 1, BRANCH: n + 2, PAIR: 2 * n + 2}[kind]
    return (
        np.zeros((7, max(size, n + p_size))), np.empty((n, n + p_size)), np.empty((n, n + 1)), np.empty((size, size)),
        np.empty(size, np.int64),
    )  # fmt: skip


@kernel("f2, i, i, f, f, b, b, i")
def enter(out, i, j, re, im, whole, transposed, half):
    """Entry i, j of a matrix, or of its transpose; `whole` : of a complex one as four real entries."""
    if transposed:
        i, j = j, i
        im = -im  # the real form's transpose is that of the conjugate transpose
    out[i, j] = re
    if whole:
        out[half + i, half + j] = re
        out[i, half + j] = -im
        out[half + i, j] = im


@kernel("i, f2, f1, f2, f2, f, f, b, f2, i1 -> b")
def factorised(kind, scaled, identity, b, c, shift_re, shift_im, transposed, out, pivots):
    """Factor the bordered matrix, or its (conjugate) transpose, in `out`; False where it is singular."""
    n = scaled.shape[0]
    columns = n + 1 if kind == BRANCH else n
    half = columns + 1
    whole = kind == PAIR
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
    for i in range(n):
        for j in range(columns):
            enter(out, i, j, scaled[i, j], 0.0, whole, transposed, half)
        if kind != BRANCH:
            re = scaled[i, i] - shift_re * identity[i]
            enter(out, i, i, re, -shift_im * identity[i], whole, transposed, half)
        enter(out, i, columns, b[0, i], b[1, i], whole, transposed, half)
    for j in range(columns):
        enter(out, n, j, c[0, j], -c[1, j] if whole else 0.0, whole, transposed, half)
        if kind == BRANCH:
            enter(out, n + 1, j, c[1, j], 0.0, False, transposed, half)
    return lu_factor(out, pivots) != 0


@kernel("i, f2, f2, f2, f1, i, i, f, f1")
def weigh(kind, scaled, x, vectors, identity, right, row, modulus, terms):
    """Sizes of the terms of the residual: |J| |x|, then |w| |B| |v| (`modulus` : of the shift, with it).

    right : row of `vectors` in which v is; of PAIR its imaginary part is in the next one.
    """
    n = scaled.shape[0]
    columns = n + 1 if kind == BRANCH else n
    total = 0.0
    for i in range(n):
        size = 0.0
        across = 0.0
        for j in range(n + 1):
            size += abs(scaled[i, j]) * abs(x[0, j])
        for j in range(columns):
            v_im = vectors[right + 1, j] if kind == PAIR else 0.0
            across += abs(scaled[i, j]) * math.hypot(vectors[right, j], v_im)
        if kind == PAIR:
            across += modulus * identity[i] * math.hypot(vectors[right, i], vectors[right + 1, i])
        terms[i] = size
        total += math.hypot(vectors[W, i], vectors[W + 1, i]) * across
    terms[row] = total
    if kind == PAIR:
        terms[row + 1] = total  # of the real and of the imaginary part


@kernel("i, f2, i1, i, i, b, f2")
def solved(kind, bordered, pivots, right, place, regular, vectors):
    """Row `right` of vectors: the solution for the unit vector `place`; of PAIR its imaginary part in the next one.

    NaN where the matrix is not regular.
    """
    v = vectors[right]
    for j in range(v.size):
        v[j] = 0.0 if regular else math.nan
    if regular:
        v[place] = 1.0
        lu_solve(bordered, pivots, v[: pivots.size])
    if kind == PAIR:
        half = pivots.size // 2
        for j in range(half):
            vectors[right + 1, j] = v[half + j]


@kernel("i, i, f1, i, f1, f1, f2, f2, f2, f2")
def differentiate(kind, second, p, active, scale, rows, vectors, jacobian, scaled, out):
    """The Jacobian's rows: J, then -w^* D^2F[v, .]."""
    n = scaled.shape[0]
    for i in range(n):
        for j in range(out.shape[1]):
            out[i, j] = scaled[i, j] if j <= n else 0.0
    for k in range(1 if kind == FOLD else 2):
        for j in range(vectors.shape[1]):
            vectors[DIRECTION, j] = vectors[V + k, j] * scale[j] if j < n else 0.0
        if kind == BRANCH:
            vectors[DIRECTION, n + active] = vectors[V + k, n] * scale[n]
        call5(second, vectors[Z], p, vectors[DIRECTION], vectors[IMAGE], jacobian)
        for j in range(n + 1):
            place = j if j < n else n + active
            along = 0.0
            across = 0.0
            for i in range(n):
                value = jacobian[i, place] * scale[j] / rows[i]
                along += vectors[W, i] * value
                across += vectors[W + 1, i] * value
            if kind != PAIR:
                out[n + k, j] = -along
            elif k == 0:  # (w - i w_im) . (first + i second)
                out[n, j] = -along
                out[n + 1, j] = across
            else:
                out[n, j] -= across
                out[n + 1, j] -= along


@kernel("i, i, b, i, f2, f1, i, f1, f1, f1, f2, f2, f, f, f2, f3, f1, f2, f2, f2, f2, i1")
def evaluate(
    address, second, is_map, kind, x, p, active, scale, rows, identity, b, c, shift, unit, residuals, matrices, terms,
    vectors, jacobian, scaled, bordered, pivots,
):  # fmt: skip
    """Residuals (m, k) at the rows of x; Jacobians of the first rows, as many as `matrices` has; `terms` of row 0.

    second : address of the second derivative's matrix along a direction.  b (2, n), c (2, n + 1) : the borders; rows
    are those of BRANCH, or the real and the imaginary part.  NaN where the bordered matrix is singular.  terms (k,) or
    empty.  vectors, jacobian, scaled, bordered, pivots : see `memory`.
    """
    n = scaled.shape[0]
    columns = n + 1 if kind == BRANCH else n
    for row in range(x.shape[0]):
        for j in range(n + 1):
            vectors[Z, j] = x[row, j] * scale[j]
        p[active] = vectors[Z, n]
        call4(address, vectors[Z], p, vectors[IMAGE], jacobian)
        for i in range(n):
            residuals[row, i] = (vectors[IMAGE, i] - vectors[Z, i] if is_map else vectors[IMAGE, i]) / rows[i]
            for j in range(n):
                value = jacobian[i, j] - 1.0 if is_map and i == j else jacobian[i, j]
                scaled[i, j] = value * scale[j] / rows[i]
            scaled[i, n] = jacobian[i, n + active] * scale[n] / rows[i]
        shift_re = shift
        shift_im = 0.0
        rate_re = 0.0
        rate_im = 1.0
        if kind == PAIR:
            shift_im = unit * x[row, n + 1]
            if is_map:
                rate_im = math.cos(shift_im)
                rate_re = -math.sin(shift_im)
                shift_re = rate_im - 1.0
                shift_im = -rate_re
        regular = factorised(kind, scaled, identity, b, c, shift_re, shift_im, False, bordered, pivots)
        solved(kind, bordered, pivots, V, n, regular, vectors)
        residuals[row, n] = vectors[V, columns]
        if kind == PAIR:
            residuals[row, n + 1] = vectors[V + 1, columns]
        if kind == BRANCH:
            solved(kind, bordered, pivots, V + 1, n + 1, regular, vectors)
            residuals[row, n + 1] = vectors[V + 1, columns]
        derived = row < matrices.shape[0]
        if not derived and (row > 0 or terms.size == 0):
            continue
        regular = regular and factorised(kind, scaled, identity, b, c, shift_re, shift_im, True, bordered, pivots)
        solved(kind, bordered, pivots, W, columns, regular, vectors)
        if row == 0 and terms.size > 0:
            modulus = math.hypot(shift_re, shift_im)
            weigh(kind, scaled, x, vectors, identity, V, n, modulus, terms)
            if kind == BRANCH:
                weigh(kind, scaled, x, vectors, identity, V + 1, n + 1, modulus, terms)
        if not derived:
            continue
        out = matrices[row]
        differentiate(kind, second, p, active, scale, rows, vectors, jacobian, scaled, out)
        if kind == PAIR:
            along = 0.0
            across = 0.0
            for i in range(n):
                along += identity[i] * (vectors[W, i] * vectors[V, i] + vectors[W + 1, i] * vectors[V + 1, i])
                across += identity[i] * (vectors[W, i] * vectors[V + 1, i] - vectors[W + 1, i] * vectors[V, i])
            out[n, n + 1] = unit * (rate_re * along - rate_im * across)
            out[n + 1, n + 1] = unit * (rate_re * across + rate_im * along)
