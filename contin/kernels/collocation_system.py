"""The linearised boundary-value problem of a periodic orbit, condensed and solved.

Unknowns are u at all nodes, the period T and a parameter p. The matrix has, for each mesh interval, m n collocation
rows
that touch only its own (m + 1) n values, T and p; then n periodicity rows, and two border rows (phase condition or
forcing period, arclength). It is eliminated in three stages, border rows along with the others:

    1. in each interval, the values at the m - 1 inner nodes        -> one block [left | right | T | p] an interval
    2. pairs of neighbouring blocks, the mesh point between them     -> half as many blocks, and so on (log2 N levels)
    3. the last block with periodicity and borders                   -> a dense system in (u(0), T, p)

Stages 1 and 2 are `eliminate` over all intervals at once, or `collocation_dense` one by one. The
condensed blocks of stage 1 also give the multipliers.
"""

from collections import namedtuple

import numpy as np

from contin.kernels.collocation import LANES
from contin.kernels.collocation_dense import (
    condense_dense,
    eliminate_intervals,
    eliminate_right_dense,
    next_level,
    substitute_back_dense,
)
from contin.kernels.collocation_elimination import eliminate, eliminate_right, substitute_back
from contin.kernels.compile import kernel, part, vector_kernel
from contin.kernels.dense import lu_factor, lu_solve

Factors = namedtuple(
    "Factors",
    [
        # Shapes for n <= LANES; beyond, the axis of the N intervals (of pivots too) comes first, not last.
        "local",  # (m n + 2, (m + 1) n + 2, N): columns [inner | left | right | T | p], last two rows the borders
        "local_pivots",
        "levels",  # (2 n + 2, 3 n + 2, N): columns [middle | left | right | T | p]
        "level_pivots",
        "blocks",  # (n + 2, 2 n + 2, N): columns [left | right | T | p]
        "nodes",  # (3, N) mesh points (left, middle, right) of the lanes of `levels`
        "depth",  # (3, 70): first lane, pairs and blocks of each level; depth[0, 69] is the number of levels
        "end",  # (n + 2, 2 n + 2): the last block
        "last",  # (n + 2, n + 2)
        "last_right_block",  # (n, n): coefficient of u(1) in the last block, for the periodicity's right-hand side
        "last_border_right",  # (2, n)
        "last_pivots",
        "work",  # (max(N, (m + 1) n + 2),)
        "panel",  # (4, m n + 2)
        "right_local",  # (m n + 2, N)
        "right_levels",  # (2 n + 2, N)
        "right_blocks",  # (n + 2, N)
        "right_last",  # (n + 2,)
        "known",  # (2 n + 2, N)
        "points",  # (n, N + 1) solution at the mesh points
        "here",  # (N + 1,) mesh points that are left at a level
    ],
)


def new_factors(n, m, intervals):
    """Memory for one matrix."""
    dense = n > LANES

    def matrices(rows, columns):
        return np.zeros((intervals, rows, columns) if dense else (rows, columns, intervals))

    def exchanges(count):
        return np.zeros((intervals, count) if dense else (count, intervals), np.int64)

    return Factors(
        matrices(m * n + 2, (m + 1) * n + 2),
        exchanges((m - 1) * n),
        matrices(2 * n + 2, 3 * n + 2),
        exchanges(n),
        matrices(n + 2, 2 * n + 2),
        np.zeros((3, intervals), np.int64),
        np.zeros((3, 70), np.int64),
        np.zeros((n + 2, 2 * n + 2)),
        np.zeros((n + 2, n + 2)),
        np.zeros((n, n)),
        np.zeros((2, n)),
        np.zeros(n + 2, np.int64),
        np.zeros(max(intervals, (m + 1) * n + 2)),
        np.zeros((4, m * n + 2)),
        np.zeros((m * n + 2, intervals)),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n + 2, intervals)),
        np.zeros(n + 2),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n, intervals + 1)),
        np.zeros(intervals + 1, np.int64),
    )


@kernel
def factorise(s, n, m, border, sign_of_end):
    """Factor s.local (filled); border (2, 2) are the border rows' coefficients of T and p.

    u(1) = sign_of_end * u(0) (1: periodic, -1: antiperiodic). Returns the sign of the determinant up to a factor that
    depends on the number of intervals only; 0 where the matrix is singular.
    """
    end = s.end
    s_last = s.last
    s_last_right_block = s.last_right_block
    s_last_border_right = s.last_border_right
    sign = condense_dense(s, n, m) if n > LANES else condense(s, n, m)
    if sign == 0:
        return 0
    for r in range(n + 2):
        for c in range(n):
            s_last[r, c] = end[r, c] + sign_of_end * end[r, n + c]
        for c in range(2):
            s_last[r, n + c] = end[r, 2 * n + c]
            if r >= n:
                s_last[r, n + c] += border[r - n, c]
    for c in range(n):
        for r in range(n):
            s_last_right_block[r, c] = end[r, n + c]
        for q in range(2):
            s_last_border_right[q, c] = end[n + q, n + c]
    part = lu_factor(s_last, s.last_pivots)
    for k in range(n + 2):
        if s_last[k, k] < 0.0:
            part = -part
    return sign * part


@part
def condense_intervals(s, n, m):
    """The first stage alone, for the multipliers. Returns the sign of the pivots, 0 where one vanishes."""
    if n > LANES:
        return eliminate_intervals(s, n, m)
    return eliminate(s.local, (m - 1) * n, m * n, 0, s.local.shape[2], s.local_pivots, s.work)


@part
def condense(s, n, m):
    """Eliminate everything but (u(0), u(1), T, p), into s.end; all lanes at once. Returns the sign of the pivots."""
    s_local = s.local
    s_work = s.work
    s_blocks = s.blocks
    s_nodes = s.nodes
    s_depth = s.depth
    s_levels = s.levels
    s_here = s.here
    intervals = s_local.shape[2]
    inner = (m - 1) * n
    sign = condense_intervals(s, n, m)
    if sign == 0:
        return 0
    for r in range(n + 2):
        for c in range(2 * n + 2):
            for i in range(np.uint64(intervals)):
                s_blocks[r, c, i] = s_local[inner + r, inner + c, i]
    for i in range(intervals + 1):
        s_here[i] = i
    count = intervals
    first = 0
    level = 0
    while count > 1:
        pairs = count // 2
        next_level(s_depth, s_nodes, s_here, level, first, count)
        _pair_up(s_blocks, s_levels, n, pairs, first)
        part = eliminate(s_levels, n, 2 * n, first, first + pairs, s.level_pivots, s_work)
        if part == 0:
            return 0
        sign *= part
        for r in range(n + 2):
            for c in range(2 * n + 2):
                for j in range(np.uint64(pairs)):
                    s_blocks[r, c, j] = s_levels[n + r, n + c, np.uint64(first) + j]
        if count % 2 == 1:
            for r in range(n + 2):
                for c in range(2 * n + 2):
                    s_blocks[r, c, pairs] = s_blocks[r, c, count - 1]
        first += pairs
        count = pairs + count % 2
        level += 1
    s_depth[0, 69] = level
    for r in range(n + 2):
        for c in range(2 * n + 2):
            s.end[r, c] = s_blocks[r, c, 0]
    return sign


@vector_kernel
def _pair_up(blocks, levels, n, pairs, first):
    """Rows of two neighbouring blocks, with the columns of the mesh point between them in front."""
    start, one, two = np.uint64(first), np.uint64(1), np.uint64(2)
    lanes = np.uint64(pairs)
    for c in range(n):
        for r in range(n):
            for j in range(lanes):
                levels[r, c, start + j] = blocks[r, n + c, two * j]
                levels[r, n + c, start + j] = blocks[r, c, two * j]
                levels[r, 2 * n + c, start + j] = 0.0
            for j in range(lanes):
                levels[n + r, c, start + j] = blocks[r, c, two * j + one]
                levels[n + r, n + c, start + j] = 0.0
                levels[n + r, 2 * n + c, start + j] = blocks[r, n + c, two * j + one]
        for q in range(2):
            for j in range(lanes):
                levels[2 * n + q, c, start + j] = blocks[n + q, n + c, two * j] + blocks[n + q, c, two * j + one]
                levels[2 * n + q, n + c, start + j] = blocks[n + q, c, two * j]
                levels[2 * n + q, 2 * n + c, start + j] = blocks[n + q, n + c, two * j + one]
    for c in range(2 * n, 2 * n + 2):
        for r in range(n):
            for j in range(lanes):
                levels[r, n + c, start + j] = blocks[r, c, two * j]
                levels[n + r, n + c, start + j] = blocks[r, c, two * j + one]
        for r in range(n, n + 2):
            for j in range(lanes):
                levels[n + r, n + c, start + j] = blocks[r, c, two * j] + blocks[r, c, two * j + one]


@kernel
def solve(s, n, m, jump, border, sign_of_end, has_local, out):
    """Solve with the factors: s.right_local (rows of the intervals, destroyed), u(1) - sign_of_end u(0) = jump (n,),
    border (2,).

    out : node values (node-major), then T, then p. Where has_local is False the intervals' right-hand sides are zero.
    """
    s_right_last = s.right_last
    s_last_right_block = s.last_right_block
    s_last_border_right = s.last_border_right
    s_points = s.points
    intervals = s_points.shape[1] - 1
    if has_local:
        reduce_right(s, n, m)
    else:
        clear_right(s, n, m)
    for q in range(2):
        s_right_last[n + q] += border[q]
    for c in range(n):
        for r in range(n):
            s_right_last[r] -= s_last_right_block[r, c] * jump[c]
        for q in range(2):
            s_right_last[n + q] -= s_last_border_right[q, c] * jump[c]
    lu_solve(s.last, s.last_pivots, s_right_last)
    for k in range(n):
        s_points[k, 0] = s_right_last[k]
        s_points[k, intervals] = sign_of_end * s_right_last[k] + jump[k]
    expand(s, n, m, s_right_last[n], s_right_last[n + 1], out)


@kernel
def clear_right(s, n, m):
    """Right-hand sides of the intervals: zero."""
    s_right_local = s.right_local
    s_right_levels = s.right_levels
    s_right_last = s.right_last
    for i in range(s.points.shape[1] - 1):
        for r in range(m * n + 2):
            s_right_local[r, i] = 0.0
        for r in range(2 * n + 2):
            s_right_levels[r, i] = 0.0
    for r in range(n + 2):
        s_right_last[r] = 0.0


@kernel
def reduce_right(s, n, m):
    """Eliminate s.right_local (collocation rows; those of the borders are taken as zero) into s.right_last (n + 2,)."""
    s_local = s.local
    s_depth = s.depth
    s_right_local = s.right_local
    s_local_pivots = s.local_pivots
    s_right_blocks = s.right_blocks
    s_right_levels = s.right_levels
    s_levels = s.levels
    s_level_pivots = s.level_pivots
    s_right_last = s.right_last
    s_work = s.work
    dense = n > LANES
    intervals = s.points.shape[1] - 1
    inner = (m - 1) * n
    level_count = s_depth[0, 69]
    for q in range(2):
        for i in range(intervals):
            s_right_local[m * n + q, i] = 0.0
    if dense:
        eliminate_right_dense(s_local, inner, 0, intervals, s_local_pivots, s_right_local, s_work)
    else:
        eliminate_right(s_local, inner, 0, intervals, s_local_pivots, s_right_local)
    for r in range(n + 2):
        for i in range(intervals):
            s_right_blocks[r, i] = s_right_local[inner + r, i]
    for level in range(level_count):
        first = s_depth[0, level]
        pairs = s_depth[1, level]
        count = s_depth[2, level]
        for j in range(pairs):
            k = first + j
            for r in range(n):
                s_right_levels[r, k] = s_right_blocks[r, 2 * j]
                s_right_levels[n + r, k] = s_right_blocks[r, 2 * j + 1]
            for q in range(2):
                s_right_levels[2 * n + q, k] = s_right_blocks[n + q, 2 * j] + s_right_blocks[n + q, 2 * j + 1]
        if dense:
            eliminate_right_dense(s_levels, n, first, first + pairs, s_level_pivots, s_right_levels, s_work)
        else:
            eliminate_right(s_levels, n, first, first + pairs, s_level_pivots, s_right_levels)
        for r in range(n + 2):
            for j in range(pairs):
                s_right_blocks[r, j] = s_right_levels[n + r, first + j]
            if count % 2 == 1:
                s_right_blocks[r, pairs] = s_right_blocks[r, count - 1]
    for r in range(n + 2):
        s_right_last[r] = s_right_blocks[r, 0]


@kernel
def expand(s, n, m, period, parameter, out):
    """Everything between u(0) and u(1), which stand in s.points, from the reduced right-hand sides: out as `solve`."""
    s_local = s.local
    s_depth = s.depth
    s_right_local = s.right_local
    s_right_levels = s.right_levels
    s_levels = s.levels
    s_points = s.points
    s_known = s.known
    s_nodes = s.nodes
    s_work = s.work
    dense = n > LANES
    intervals = s_points.shape[1] - 1
    inner = (m - 1) * n
    level_count = s_depth[0, 69]
    for level in range(level_count - 1, -1, -1):
        first = s_depth[0, level]
        beyond = first + s_depth[1, level]
        for k in range(n):
            for j in range(first, beyond):
                s_known[k, j] = s_points[k, s_nodes[0, j]]
                s_known[n + k, j] = s_points[k, s_nodes[2, j]]
        for j in range(first, beyond):
            s_known[2 * n, j] = period
            s_known[2 * n + 1, j] = parameter
        if dense:
            substitute_back_dense(s_levels, n, first, beyond, s_known, s_right_levels, s_work)
        else:
            substitute_back(s_levels, n, first, beyond, s_known, s_right_levels)
        for k in range(n):
            for j in range(first, beyond):
                s_points[k, s_nodes[1, j]] = s_right_levels[k, j]
    for k in range(n):
        for i in range(intervals):
            s_known[k, i] = s_points[k, i]
            s_known[n + k, i] = s_points[k, i + 1]
    for i in range(intervals):
        s_known[2 * n, i] = period
        s_known[2 * n + 1, i] = parameter
    if dense:
        substitute_back_dense(s_local, inner, 0, intervals, s_known, s_right_local, s_work)
    else:
        substitute_back(s_local, inner, 0, intervals, s_known, s_right_local)
    for i in range(intervals):
        for k in range(n):
            out[i * m * n + k] = s_points[k, i]
        for r in range(inner):
            out[i * m * n + n + r] = s_right_local[r, i]
    nodes = intervals * m * n
    for k in range(n):
        out[nodes + k] = s_points[k, intervals]
    out[nodes + n] = period
    out[nodes + n + 1] = parameter
