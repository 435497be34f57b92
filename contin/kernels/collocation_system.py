"""The linearised boundary-value problem of a periodic orbit, condensed and solved.

Unknowns are u at all nodes, the period T and a parameter p. The matrix has, for each mesh interval, m n collocation
rows that touch only its own (m + 1) n values, T and p; then n periodicity rows, and two border rows (phase condition
or forcing period, arclength). It is eliminated in four stages, border rows along with the others:

    1. in each interval the outer pair of stages (`contin.kernels.stages`)          -> `local`
    2. in each interval the inner stages                      -> one block [left | right | T | p] an interval
    3. pairs of neighbouring blocks, the mesh point between them (`contin.kernels.condensation`), log2 N levels
    4. the last block with periodicity and borders            -> a dense system in (u(0), T, p)

Stages 1 to 3 run over all intervals at once with n <= LANES, else over one after another (`collocation_dense`). The
blocks of stage 2 also give the multipliers.
"""

from collections import namedtuple

import numpy as np

from contin.kernels.collocation import LANES
from contin.kernels.collocation_dense import eliminate_right_dense, substitute_back_dense
from contin.kernels.collocation_elimination import eliminate_right, substitute_back
from contin.kernels.compile import kernel
from contin.kernels.condensation import condense
from contin.kernels.dense import lu_factor_weighted, lu_solve
from contin.kernels.signature import structure
from contin.kernels.stages import new_stages
from contin.kernels.stages_dense import expand_stages_dense, reduce_stages_dense
from contin.kernels.stages_lanes import expand_stages, nodes_of_stages, reduce_stages

Factors = namedtuple(
    "Factors",
    [
        # Shapes for n <= LANES; beyond, the axis of the N intervals (of pivots too) comes first, not last.
        "stages",  # `Stages`
        "local",  # ((m - 1) n + 2, (m - 1) n + 2, N): columns [inner stages | left | T | p], rows [inner stages |
        # right end | borders]; the right end's own block is the identity
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
        "work",  # (max(N, (m + 1) n + 2, 3 n + 2) + 4,)
        "panel",  # (4, max(m n, 2 n) + 2)
        "right_local",  # (m n, N) right-hand sides of the collocation equations
        "right_inner",  # ((m - 1) n + 2, N) those of `local`
        "right_levels",  # (2 n + 2, N)
        "right_blocks",  # (n + 2, N)
        "right_last",  # (n + 2,)
        "known",  # (2 n + 2, N)
        "points",  # (n, N + 1) solution at the mesh points
        "here",  # (N + 1,) mesh points that are left at a level
    ],
)
structure(Factors, "Stages, f3, i2, f3, i2, f3, i2, i2, f2, f2, f2, f2, i1, f1, f2, f2, f2, f2, f2, f1, f2, f2, i1")


def new_factors(n, m, intervals):
    """Memory for one matrix."""
    dense = n > LANES

    def matrices(rows, columns):
        return np.zeros((intervals, rows, columns) if dense else (rows, columns, intervals))

    def exchanges(count):
        return np.zeros((intervals, count) if dense else (count, intervals), np.int64)

    return Factors(
        new_stages(n, m, intervals, dense),
        matrices((m - 1) * n + 2, (m - 1) * n + 2),
        exchanges((m - 2) * n),
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
        np.zeros(max(intervals, (m + 1) * n + 2, 3 * n + 2) + 4),
        np.zeros((4, max(m * n, 2 * n) + 2)),
        np.zeros((m * n, intervals)),
        np.zeros(((m - 1) * n + 2, intervals)),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n + 2, intervals)),
        np.zeros(n + 2),
        np.zeros((2 * n + 2, intervals)),
        np.zeros((n, intervals + 1)),
        np.zeros(intervals + 1, np.int64),
    )


@kernel("Factors, i, i, f2, f -> i")
def factorise(s, n, m, border, sign_of_end):
    """Factor what `contin.kernels.filling.fill` has left; border (2, 2) are the border rows' coefficients of T and p.

    u(1) = sign_of_end * u(0) (1: periodic, -1: antiperiodic). Returns the sign of the determinant up to a factor that
    depends on the number of intervals only; 0 where the matrix is singular.
    """
    end = s.end
    s_last = s.last
    s_last_right_block = s.last_right_block
    s_last_border_right = s.last_border_right
    sign = condense(s, n, m)
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
    part = lu_factor_weighted(s_last, s.last_pivots, s.stages.weights, n, s.stages.row_weights)
    for k in range(n + 2):
        if s_last[k, k] < 0.0:
            part = -part
    return sign * part


@kernel("Factors, i, i, f1, f1, f, b, f1")
def solve(s, n, m, jump, border, sign_of_end, has_local, out):
    """Solve with the factors: s.right_local (rows of the intervals), u(1) - sign_of_end u(0) = jump (n,),
    border (2,).

    out : node values (node-major), then T, then p. Where has_local is False the intervals' right-hand sides are zero.
    """
    points, start = s.points, s.right_last
    intervals = points.shape[1] - 1
    if has_local:
        reduce_right(s, n, m)
    else:
        clear_right(s, n, m)
    _solve_last(s, n, jump, border)
    for k in range(n):
        points[k, 0] = start[k]
        points[k, intervals] = sign_of_end * start[k] + jump[k]
    expand(s, n, m, start[n], start[n + 1], out)


@kernel("Factors, i, f1, f1")
def solve_start(s, n, jump, border):
    """As `solve` without right-hand sides of the intervals, for (u(0), T, p) alone, into s.right_last (n + 2,)."""
    for r in range(n + 2):
        s.right_last[r] = 0.0
    _solve_last(s, n, jump, border)


@kernel("Factors, i, f1, f1")
def _solve_last(s, n, jump, border):
    """s.right_last, the reduced right-hand sides of the intervals, becomes (u(0), T, p)."""
    right, block, below = s.right_last, s.last_right_block, s.last_border_right
    for q in range(2):
        right[n + q] += border[q]
    for c in range(n):
        for r in range(n):
            right[r] -= block[r, c] * jump[c]
        for q in range(2):
            right[n + q] -= below[q, c] * jump[c]
    lu_solve(s.last, s.last_pivots, right)


@kernel("Factors, i, i")
def clear_right(s, n, m):
    """Right-hand sides of the intervals: zero."""
    outer, right_inner, right_levels, right_last = s.stages.outer, s.right_inner, s.right_levels, s.right_last
    for i in range(s.points.shape[1] - 1):
        for r in range(2 * n):
            outer[r, i] = 0.0
        for r in range((m - 2) * n):
            right_inner[r, i] = 0.0
        for r in range(n):
            right_levels[r, i] = 0.0
    for r in range(n + 2):
        right_last[r] = 0.0


@kernel("Factors, i, i")
def reduce_right(s, n, m):
    """Eliminate s.right_local (collocation rows; those of the borders are taken as zero) into s.right_last (n + 2,)."""
    local, levels, depth = s.local, s.levels, s.depth
    right_inner, right_blocks, right_levels, right_last = s.right_inner, s.right_blocks, s.right_levels, s.right_last
    dense = n > LANES
    intervals = s.points.shape[1] - 1
    inner = (m - 2) * n
    if dense:
        reduce_stages_dense(s.stages, n, m, s.right_local, right_inner)
        eliminate_right_dense(local, inner, 0, intervals, s.local_pivots, right_inner, s.work)
    else:
        reduce_stages(s.stages, n, m, s.right_local, right_inner)
        eliminate_right(local, inner, 0, intervals, s.local_pivots, right_inner)
    for r in range(n + 2):
        for i in range(intervals):
            right_blocks[r, i] = right_inner[inner + r, i]
    for level in range(depth[0, 69]):
        first = depth[0, level]
        pairs = depth[1, level]
        count = depth[2, level]
        for j in range(pairs):
            k = first + j
            for r in range(n):
                right_levels[r, k] = right_blocks[r, 2 * j]
                right_levels[n + r, k] = right_blocks[r, 2 * j + 1]
            for q in range(2):
                right_levels[2 * n + q, k] = right_blocks[n + q, 2 * j] + right_blocks[n + q, 2 * j + 1]
        if dense:
            eliminate_right_dense(levels, n, first, first + pairs, s.level_pivots, right_levels, s.work)
        else:
            eliminate_right(levels, n, first, first + pairs, s.level_pivots, right_levels)
        for r in range(n + 2):
            for j in range(pairs):
                right_blocks[r, j] = right_levels[n + r, first + j]
            if count % 2 == 1:
                right_blocks[r, pairs] = right_blocks[r, count - 1]
    for r in range(n + 2):
        right_last[r] = right_blocks[r, 0]


@kernel("Factors, i, i, f, f, f1")
def expand(s, n, m, period, parameter, out):
    """Everything between u(0) and u(1), which stand in s.points, from the reduced right-hand sides: out as `solve`."""
    local, levels, depth, nodes = s.local, s.levels, s.depth, s.nodes
    right_inner, right_levels, points, known = s.right_inner, s.right_levels, s.points, s.known
    dense = n > LANES
    intervals = points.shape[1] - 1
    inner = (m - 2) * n
    for level in range(depth[0, 69] - 1, -1, -1):
        first = depth[0, level]
        beyond = first + depth[1, level]
        for k in range(n):
            for j in range(first, beyond):
                known[k, j] = points[k, nodes[0, j]]
                known[n + k, j] = points[k, nodes[2, j]]
        for j in range(first, beyond):
            known[2 * n, j] = period
            known[2 * n + 1, j] = parameter
        if dense:
            substitute_back_dense(levels, n, first, beyond, known, right_levels, s.work)
        else:
            substitute_back(levels, n, first, beyond, known, right_levels)
        for k in range(n):
            for j in range(first, beyond):
                points[k, nodes[1, j]] = right_levels[k, j]
    for k in range(n):
        for i in range(intervals):
            known[k, i] = points[k, i]
    for i in range(intervals):
        known[n, i] = period
        known[n + 1, i] = parameter
    if dense:
        substitute_back_dense(local, inner, 0, intervals, known, right_inner, s.work)
        expand_stages_dense(s.stages, n, m, points, right_inner, period, parameter)
    else:
        substitute_back(local, inner, 0, intervals, known, right_inner)
        expand_stages(s.stages, n, m, points, right_inner, period, parameter)
    for k in range(n):
        for i in range(intervals):
            out[i * m * n + k] = points[k, i]
    for j in range(1, m):
        nodes_of_stages(s.stages, n, m, j, points, known)
        for k in range(n):
            for i in range(intervals):
                out[(i * m + j) * n + k] = known[k, i]
    last = intervals * m * n
    for k in range(n):
        out[last + k] = points[k, intervals]
    out[last + n] = period
    out[last + n + 1] = parameter
