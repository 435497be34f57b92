"""The linearised boundary-value problem of a periodic orbit, condensed and solved.

Unknowns are u at all nodes, the period T and a parameter p. The matrix has, for each mesh interval, m n collocation rows
that touch only its own (m + 1) n values, T and p; then n periodicity rows, and two border rows (phase condition or
forcing period, arclength). It is eliminated in three stages, border rows along with the others:

    1. in each interval, the values at the m - 1 inner nodes        -> one block [left | right | T | p] an interval
    2. pairs of neighbouring blocks, the mesh point between them     -> half as many blocks, and so on (log2 N levels)
    3. the last block with periodicity and borders                   -> a dense system in (u(0), T, p)

Stages 1 and 2 are `eliminate` over all intervals at once. The condensed blocks of stage 1 also give the multipliers.
"""

from collections import namedtuple

import numpy as np

from contin.kernels.collocation_elimination import eliminate, eliminate_right, substitute_back
from contin.kernels.compile import kernel
from contin.kernels.dense import lu_factor, lu_solve

Factors = namedtuple(
    "Factors",
    [
        "local",  # (m n + 2, (m + 1) n + 2, N): columns [inner | left | right | T | p], last two rows the borders
        "local_pivots",
        "levels",  # (2 n + 2, 3 n + 2, N): columns [middle | left | right | T | p]
        "level_pivots",
        "blocks",  # (n + 2, 2 n + 2, N): columns [left | right | T | p]
        "nodes",  # (3, N) mesh points (left, middle, right) of the lanes of `levels`
        "depth",  # (3, 70): first lane, pairs and blocks of each level; depth[0, 69] is the number of levels
        "last",  # (n + 2, n + 2)
        "last_right_block",  # (n, n): coefficient of u(1) in the last block, for the periodicity's right-hand side
        "last_border_right",  # (2, n)
        "last_pivots",
        "work",  # (N,)
        "right_local",  # (m n + 2, N)
        "right_levels",  # (2 n + 2, N)
        "right_blocks",  # (n + 2, N)
        "right_last",  # (n + 2,)
        "known",  # (2 n + 2, N)
        "points",  # (n, N + 1) solution at the mesh points
    ],
)


@kernel
def new_factors(n, m, intervals):
    """Memory for one matrix."""
    return Factors(
        np.zeros((m * n + 2, (m + 1) * n + 2, intervals)),
        np.zeros(((m - 1) * n, intervals), np.int64),
        np.zeros((2 * n + 2, 3 * n + 2, intervals)),
        np.zeros((n, intervals), np.int64),
        np.zeros((n + 2, 2 * n + 2, intervals)),
        np.zeros((3, intervals), np.int64),
        np.zeros((3, 70), np.int64),
        np.zeros((n + 2, n + 2)),
        np.zeros((n, n)),
        np.zeros((2, n)),
        np.zeros(n + 2, np.int64),
        np.zeros(intervals),
        np.zeros((m * n + 2, intervals)),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n + 2, intervals)),
        np.zeros(n + 2),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n, intervals + 1)),
    )


@kernel
def factorise(s, n, m, border, sign_of_end):
    """Factor s.local (filled); border (2, 2) are the border rows' coefficients of T and p.

    u(1) = sign_of_end * u(0) (1: periodic, -1: antiperiodic). Returns the sign of the determinant up to a factor that
    depends on the number of intervals only; 0 where the matrix is singular.
    """
    intervals = s.local.shape[2]
    inner = (m - 1) * n
    sign = eliminate(s.local, inner, m * n, 0, intervals, s.local_pivots, s.work)
    if sign == 0:
        return 0
    for r in range(n + 2):
        for c in range(2 * n + 2):
            for i in range(intervals):
                s.blocks[r, c, i] = s.local[inner + r, inner + c, i]
    left = s.nodes[0]
    right = s.nodes[2]
    here = np.arange(intervals + 1)
    count = intervals
    first = 0
    level = 0
    while count > 1:
        pairs = count // 2
        s.depth[0, level] = first
        s.depth[1, level] = pairs
        s.depth[2, level] = count
        for j in range(pairs):
            left[first + j] = here[2 * j]
            s.nodes[1, first + j] = here[2 * j + 1]
            right[first + j] = here[2 * j + 2]
        _pair_up(s.blocks, s.levels, n, pairs, first)
        part = eliminate(s.levels, n, 2 * n, first, first + pairs, s.level_pivots, s.work)
        if part == 0:
            return 0
        sign *= part
        for r in range(n + 2):
            for c in range(2 * n + 2):
                for j in range(pairs):
                    s.blocks[r, c, j] = s.levels[n + r, n + c, first + j]
        for j in range(pairs):
            here[j + 1] = here[2 * j + 2]
        if count % 2 == 1:
            for r in range(n + 2):
                for c in range(2 * n + 2):
                    s.blocks[r, c, pairs] = s.blocks[r, c, count - 1]
            here[pairs + 1] = here[count]
        first += pairs
        count = pairs + count % 2
        level += 1
    s.depth[0, 69] = level
    for r in range(n + 2):
        for c in range(n):
            s.last[r, c] = s.blocks[r, c, 0] + sign_of_end * s.blocks[r, n + c, 0]
        for c in range(2):
            s.last[r, n + c] = s.blocks[r, 2 * n + c, 0]
            if r >= n:
                s.last[r, n + c] += border[r - n, c]
    for c in range(n):
        for r in range(n):
            s.last_right_block[r, c] = s.blocks[r, n + c, 0]
        for q in range(2):
            s.last_border_right[q, c] = s.blocks[n + q, n + c, 0]
    part = lu_factor(s.last, s.last_pivots)
    for k in range(n + 2):
        if s.last[k, k] < 0.0:
            part = -part
    return sign * part


@kernel
def _pair_up(blocks, levels, n, pairs, first):
    """Rows of two neighbouring blocks, with the columns of the mesh point between them in front."""
    for c in range(n):
        for r in range(n):
            for j in range(pairs):
                k = first + j
                levels[r, c, k] = blocks[r, n + c, 2 * j]
                levels[r, n + c, k] = blocks[r, c, 2 * j]
                levels[r, 2 * n + c, k] = 0.0
                levels[n + r, c, k] = blocks[r, c, 2 * j + 1]
                levels[n + r, n + c, k] = 0.0
                levels[n + r, 2 * n + c, k] = blocks[r, n + c, 2 * j + 1]
        for q in range(2):
            for j in range(pairs):
                k = first + j
                levels[2 * n + q, c, k] = blocks[n + q, n + c, 2 * j] + blocks[n + q, c, 2 * j + 1]
                levels[2 * n + q, n + c, k] = blocks[n + q, c, 2 * j]
                levels[2 * n + q, 2 * n + c, k] = blocks[n + q, n + c, 2 * j + 1]
    for c in range(2):
        for j in range(pairs):
            k = first + j
            for r in range(n):
                levels[r, 3 * n + c, k] = blocks[r, 2 * n + c, 2 * j]
                levels[n + r, 3 * n + c, k] = blocks[r, 2 * n + c, 2 * j + 1]
            for q in range(2):
                levels[2 * n + q, 3 * n + c, k] = blocks[n + q, 2 * n + c, 2 * j] + blocks[n + q, 2 * n + c, 2 * j + 1]


@kernel
def solve(s, n, m, jump, border, sign_of_end, has_local, out):
    """Solve with the factors: s.right_local (rows of the intervals, destroyed), u(1) - sign_of_end u(0) = jump (n,), border (2,).

    out : node values (node-major), then T, then p. Where has_local is False the intervals' right-hand sides are zero.
    """
    intervals = s.local.shape[2]
    inner = (m - 1) * n
    level_count = s.depth[0, 69]
    if has_local:
        s.right_local[m * n :, :] = 0.0
        eliminate_right(s.local, inner, 0, intervals, s.local_pivots, s.right_local)
        for r in range(n + 2):
            for i in range(intervals):
                s.right_blocks[r, i] = s.right_local[inner + r, i]
        for level in range(level_count):
            first = s.depth[0, level]
            pairs = s.depth[1, level]
            count = s.depth[2, level]
            for j in range(pairs):
                k = first + j
                for r in range(n):
                    s.right_levels[r, k] = s.right_blocks[r, 2 * j]
                    s.right_levels[n + r, k] = s.right_blocks[r, 2 * j + 1]
                for q in range(2):
                    s.right_levels[2 * n + q, k] = s.right_blocks[n + q, 2 * j] + s.right_blocks[n + q, 2 * j + 1]
            eliminate_right(s.levels, n, first, first + pairs, s.level_pivots, s.right_levels)
            for r in range(n + 2):
                for j in range(pairs):
                    s.right_blocks[r, j] = s.right_levels[n + r, first + j]
                if count % 2 == 1:
                    s.right_blocks[r, pairs] = s.right_blocks[r, count - 1]
        for r in range(n + 2):
            s.right_last[r] = s.right_blocks[r, 0]
    else:
        s.right_local[:, :] = 0.0
        s.right_levels[:, :] = 0.0
        s.right_last[:] = 0.0
    for q in range(2):
        s.right_last[n + q] += border[q]
    for c in range(n):
        for r in range(n):
            s.right_last[r] -= s.last_right_block[r, c] * jump[c]
        for q in range(2):
            s.right_last[n + q] -= s.last_border_right[q, c] * jump[c]
    lu_solve(s.last, s.last_pivots, s.right_last)
    for k in range(n):
        s.points[k, 0] = s.right_last[k]
        s.points[k, intervals] = sign_of_end * s.right_last[k] + jump[k]
    period = s.right_last[n]
    parameter = s.right_last[n + 1]
    for level in range(level_count - 1, -1, -1):
        first = s.depth[0, level]
        beyond = first + s.depth[1, level]
        for k in range(n):
            for j in range(first, beyond):
                s.known[k, j] = s.points[k, s.nodes[0, j]]
                s.known[n + k, j] = s.points[k, s.nodes[2, j]]
        for j in range(first, beyond):
            s.known[2 * n, j] = period
            s.known[2 * n + 1, j] = parameter
        substitute_back(s.levels, n, first, beyond, s.known, s.right_levels)
        for k in range(n):
            for j in range(first, beyond):
                s.points[k, s.nodes[1, j]] = s.right_levels[k, j]
    for k in range(n):
        for i in range(intervals):
            s.known[k, i] = s.points[k, i]
            s.known[n + k, i] = s.points[k, i + 1]
    for i in range(intervals):
        s.known[2 * n, i] = period
        s.known[2 * n + 1, i] = parameter
    substitute_back(s.local, inner, 0, intervals, s.known, s.right_local)
    for i in range(intervals):
        for k in range(n):
            out[i * m * n + k] = s.points[k, i]
        for r in range(inner):
            out[i * m * n + n + r] = s.right_local[r, i]
    nodes = intervals * m * n
    for k in range(n):
        out[nodes + k] = s.points[k, intervals]
    out[nodes + n] = period
    out[nodes + n + 1] = parameter
