"""What is left of the mesh intervals, blocks [left | right | T | p], joined pair by pair until one remains.

The mesh point between two neighbouring blocks is eliminated, with pivots from both, so growth in one interval and
decay in the next do not meet in a product. log2 N levels; with n <= LANES all pairs of a level at once.
"""

import numpy as np

from contin.kernels.collocation import LANES
from contin.kernels.collocation_dense import eliminate_dense
from contin.kernels.collocation_elimination import eliminate
from contin.kernels.compile import kernel, vector_kernel


@kernel("Factors, i, i -> i")
def condense(s, n, m):
    """Eliminate everything but (u(0), u(1), T, p) of `Factors` s, into s.end; returns the sign of the pivots."""
    return condense_dense(s, n, m) if n > LANES else condense_lanes(s, n, m)


@kernel("i2, i2, i1, i, i, i")
def next_level(depth, nodes, here, level, first, count):
    """Note which mesh points the pairs of neighbouring blocks join; `here` keeps those that are left."""
    pairs = count // 2
    depth[0, level] = first
    depth[1, level] = pairs
    depth[2, level] = count
    for j in range(pairs):
        nodes[0, first + j] = here[2 * j]
        nodes[1, first + j] = here[2 * j + 1]
        nodes[2, first + j] = here[2 * j + 2]
    for j in range(pairs):
        here[j + 1] = here[2 * j + 2]
    if count % 2 == 1:
        here[pairs + 1] = here[count]


@kernel("Factors, i, i -> i")
def eliminate_intervals(s, n, m):
    """The inner stages of every interval; returns the sign of the pivots, 0 where one vanishes."""
    inner, sizes, weights = (m - 2) * n, s.stages.weights, s.stages.row_weights
    if n <= LANES:
        return eliminate(s.local, inner, inner, 0, s.local.shape[2], s.local_pivots, sizes, weights, s.work)
    sign = 1
    for i in range(s.local.shape[0]):
        part = eliminate_dense(s.local, i, inner, inner, s.local_pivots, sizes, weights, s.panel)
        if part == 0:
            return 0
        sign *= part
    return sign


@kernel("Factors, i, i -> i")
def condense_lanes(s, n, m):
    """Eliminate everything but (u(0), u(1), T, p), into s.end; all lanes at once. Returns the sign of the pivots."""
    s_local, s_blocks, s_levels, s_work = s.local, s.blocks, s.levels, s.work
    s_nodes, s_depth, s_here = s.nodes, s.depth, s.here
    sizes, weights = s.stages.weights, s.stages.row_weights
    intervals = s_local.shape[2]
    sign = eliminate_intervals(s, n, m)
    if sign == 0:
        return 0
    _first_blocks(s_local, n, (m - 2) * n, s_blocks)
    for i in range(intervals + 1):
        s_here[i] = i
    count = intervals
    first = 0
    level = 0
    while count > 1:
        pairs = count // 2
        next_level(s_depth, s_nodes, s_here, level, first, count)
        _pair_up(s_blocks, s_levels, n, pairs, first)
        part = eliminate(s_levels, n, 2 * n, first, first + pairs, s.level_pivots, sizes, weights, s_work)
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


@vector_kernel("f3, i, i, f3")
def _first_blocks(local, n, inner, blocks):
    """Blocks of the intervals: what is left of `local`, with an identity for the right end."""
    lanes = np.uint64(local.shape[2])
    for r in range(n + 2):
        for c in range(n):
            same = 1.0 if r == c else 0.0
            for i in range(lanes):
                blocks[r, c, i] = local[inner + r, inner + c, i]
                blocks[r, n + c, i] = same
        for c in range(2):
            for i in range(lanes):
                blocks[r, 2 * n + c, i] = local[inner + r, inner + n + c, i]


@vector_kernel("f3, f3, i, i, i")
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


@kernel("Factors, i, i -> i")
def condense_dense(s, n, m):
    """Eliminate everything but (u(0), u(1), T, p) of `Factors` s, into s.end; returns the sign of the pivots."""
    local, levels, blocks, here = s.local, s.levels, s.blocks, s.here
    sizes, weights = s.stages.weights, s.stages.row_weights
    intervals = local.shape[0]
    sign = eliminate_intervals(s, n, m)
    if sign == 0:
        return 0
    for i in range(intervals):
        _first_block(local, i, n, (m - 2) * n, blocks)
    for i in range(intervals + 1):
        here[i] = i
    count = intervals
    first = 0
    level = 0
    while count > 1:
        pairs = count // 2
        next_level(s.depth, s.nodes, here, level, first, count)
        for j in range(pairs):
            k = first + j
            _join(blocks, levels, n, j, k)
            part = eliminate_dense(levels, k, n, 2 * n, s.level_pivots, sizes, weights, s.panel)
            if part == 0:
                return 0
            sign *= part
            _keep(levels, k, n, blocks, j)
        if count % 2 == 1:
            _keep(blocks, count - 1, 0, blocks, pairs)
        first += pairs
        count = pairs + count % 2
        level += 1
    s.depth[0, 69] = level
    for r in range(n + 2):
        for c in range(2 * n + 2):
            s.end[r, c] = blocks[0, r, c]
    return sign


@vector_kernel("f3, i, i, i, f3")
def _first_block(local, i, n, inner, blocks):
    """Block i: what is left of local[i], with an identity for the right end."""
    one = np.uint64(n)
    first = np.uint64(inner)
    for r in range(np.uint64(n + 2)):
        for c in range(one):
            blocks[i, r, c] = local[i, first + r, first + c]
            blocks[i, r, one + c] = 1.0 if r == c else 0.0
        for c in range(np.uint64(2)):
            blocks[i, r, one + one + c] = local[i, first + r, first + one + c]


@vector_kernel("f3, i, i, f3, i")
def _keep(a, i, count, blocks, j):
    """blocks[j] = what is left of a[i] without its first `count` rows and columns."""
    first = np.uint64(count)
    for r in range(np.uint64(blocks.shape[1])):
        for c in range(np.uint64(blocks.shape[2])):
            blocks[j, r, c] = a[i, first + r, first + c]


@vector_kernel("f3, f3, i, i, i")
def _join(blocks, levels, n, j, k):
    """Rows of blocks 2 j and 2 j + 1, with the columns of the mesh point between them in front."""
    a, b = 2 * j, 2 * j + 1
    one, two, three = np.uint64(n), np.uint64(2 * n), np.uint64(3 * n)
    for r in range(one):
        for c in range(one):
            levels[k, r, c] = blocks[a, r, one + c]
            levels[k, r, one + c] = blocks[a, r, c]
            levels[k, r, two + c] = 0.0
        for c in range(one):
            levels[k, one + r, c] = blocks[b, r, c]
            levels[k, one + r, one + c] = 0.0
            levels[k, one + r, two + c] = blocks[b, r, one + c]
        for c in range(np.uint64(2)):
            levels[k, r, three + c] = blocks[a, r, two + c]
            levels[k, one + r, three + c] = blocks[b, r, two + c]
    for q in range(np.uint64(2)):
        for c in range(one):
            levels[k, two + q, c] = blocks[a, one + q, one + c] + blocks[b, one + q, c]
            levels[k, two + q, one + c] = blocks[a, one + q, c]
            levels[k, two + q, two + c] = blocks[b, one + q, one + c]
        for c in range(np.uint64(2)):
            levels[k, two + q, three + c] = blocks[a, one + q, two + c] + blocks[b, one + q, two + c]
