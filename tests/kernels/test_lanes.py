"""Many small matrices at once against numpy, at every remainder of rows, columns and lanes."""

from itertools import product

import numpy as np
import pytest

from contin.kernels.collocation import LANES
from contin.kernels.collocation_elimination import eliminate, eliminate_right, substitute_back
from contin.kernels.collocation_system import new_factors
from contin.kernels.lanes import subtract_products
from contin.kernels.stages import GROWTH
from contin.kernels.stages_dense import invert_pair_dense
from contin.kernels.stages_lanes import invert_pair
from contin.machine import elementary
from tests.kernels.test_collocation import random_problem


@pytest.mark.parametrize(("rows", "depth"), [*product((1, 2, 3, 4, 7), (0, 1, 4))])
def test_products_are_subtracted_in_every_lane_and_nothing_else_is_touched(rows, depth):
    generator = np.random.default_rng(10 * rows + depth)
    for columns, lanes in product((1, 2, 3, 4, 6), (1, 2, 3, 4, 5, 11)):
        far = lanes + 2
        c = generator.normal(size=(rows + 1, columns + 1, far))
        f, p = generator.normal(size=(rows, 6, far)), generator.normal(size=(max(depth, 1), columns, far))
        expected = c.copy()
        products = np.einsum("rki,kci->rci", f[:, :depth], p[:depth])
        expected[:rows, :columns, 1 : lanes + 1] -= products[:, :, 1 : lanes + 1]
        at, left, right = (x.ctypes.data + 8 for x in (c, f, p))
        subtract_products(at, c.shape[1] * far, rows, columns, left, 6 * far, right, columns * far, depth, far, lanes)
        np.testing.assert_allclose(c, expected, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize(("count", "rest"), [(1, 2), (2, 4), (4, 4), (6, 5), (8, 6)])
@pytest.mark.parametrize("lanes", [1, 3, 4, 6])
def test_elimination_forward_and_back_solves_the_block_systems(count, rest, lanes):
    """[A B; C D] [x; y] = [f; g]: elimination leaves S = D - C A^-1 B and g - C A^-1 f, and x from y."""
    generator = np.random.default_rng(count)
    size, low, far = count + rest, 2, lanes + 3
    matrices = generator.normal(size=(size, size, far))
    matrices[:count, :, low] = matrices[:count, :, low][::-1].copy()  # rows that have to be exchanged
    y, f = generator.normal(size=(rest, far)), generator.normal(size=(size, far))
    a, right = matrices.copy(), f.copy()
    pivots, used = np.zeros((count, far), np.int64), slice(low, low + lanes)
    sign = eliminate(a, count, count, low, low + lanes, pivots, np.ones(count), np.ones((count, far)), np.zeros(far))
    tops = np.moveaxis(matrices[:count, :count, used], 2, 0)
    assert sign == np.prod(np.linalg.slogdet(tops)[0])
    eliminate_right(a, count, low, low + lanes, pivots, right)
    reduced = right[count:].copy()
    substitute_back(a, count, low, low + lanes, y, right)
    for i in range(low, low + lanes):
        top, bottom = matrices[:count, :, i], matrices[count:, :, i]
        solved = np.linalg.solve(top[:, :count], np.column_stack([f[:count, i], top[:, count:]]))
        np.testing.assert_allclose(reduced[:, i], f[count:, i] - bottom[:, :count] @ solved[:, 0], atol=1e-9)
        schur = bottom[:, count:] - bottom[:, :count] @ solved[:, 1:]
        np.testing.assert_allclose(a[count:, count:, i], schur, atol=1e-9)
        np.testing.assert_allclose(right[:count, i], solved[:, 0] - solved[:, 1:] @ y[:, i], atol=1e-9)
    untouched = np.ones(far, bool)
    untouched[used] = False
    np.testing.assert_array_equal(a[:, :, untouched], matrices[:, :, untouched])


def test_a_singular_matrix_among_others_is_told():
    a = np.random.default_rng(1).normal(size=(4, 4, 6))
    a[:, 1, 4] = 0.0
    assert eliminate(a, 2, 2, 0, 6, np.zeros((2, 6), np.int64), np.ones(2), np.ones((2, 6)), np.zeros(6)) == 0


@pytest.mark.parametrize("m", [2, 4])
@pytest.mark.parametrize("n", [2, 5, LANES + 1, LANES + 4])
@pytest.mark.parametrize("meeting", [False, True])
def test_the_inverse_of_the_outer_pair_of_stages(n, m, meeting):
    """Also where h T times an eigenvalue of the first Jacobian is that at which its own block is singular."""
    generator = np.random.default_rng(n + 10 * m)
    e, w, z, _, _ = random_problem(generator, n, m, 6)
    factors = new_factors(n, m, 6)
    g, period, dense = factors.stages, float(z[(6 * m + 1) * n]), n > LANES
    fu = w.fu if dense else np.moveaxis(w.fu, -1, 0)  # (N, m, n, n)
    fu *= 0.1
    d = g.differences
    if meeting:
        fu[3, 0] = np.diag(np.r_[d[0, 1] / (period * w.h[3]), np.zeros(n - 1)])
    if dense:
        signs = [invert_pair_dense(e, w, period, g, i, factors.panel) for i in range(6)]
        sign, inverse = int(np.prod(signs)), g.inverse
    else:
        sign, inverse = invert_pair(e, w, period, g, factors.work), np.moveaxis(g.inverse, -1, 0)
    expected = []
    for i in range(6):
        first, last = (d[c, 1 + c] * np.eye(n) - w.h[i] * period * fu[i, c] for c in (0, m - 1))
        pair = np.block([[first, d[0, m] * np.eye(n)], [d[m - 1, 1] * np.eye(n), last]])
        expected.append(np.linalg.slogdet(pair)[0])
        bound = 50.0 * GROWTH * np.finfo(float).eps * np.linalg.cond(pair)
        assert np.abs(inverse[i] @ pair - np.eye(2 * n)).max() < bound
    assert sign == np.prod(expected)


@pytest.mark.parametrize("count", [3, 6])
def test_pivots_are_those_of_rows_measured_in_their_sizes(count):
    """Rows in units 1e8 and 1e-8: the same pivots as in ordinary units, and multipliers that are as small."""
    generator = np.random.default_rng(count)
    a = generator.normal(size=(count, count, 4))
    sizes = elementary.pow(np.full(count, 10.0), generator.uniform(-8.0, 8.0, count))
    wide, pivots, others = a * sizes[:, None, None], np.zeros((count, 4), np.int64), np.zeros((count, 4), np.int64)
    ones, memory = np.ones(count), np.ones((count, 4))
    sign = eliminate(a, count, count, 0, 4, pivots, ones, memory, np.zeros(4))
    assert eliminate(wide, count, count, 0, 4, others, 1.0 / sizes, memory, np.zeros(4)) == sign
    np.testing.assert_array_equal(others, pivots)
    for i in range(4):
        order = np.arange(count)
        for k, p in enumerate(pivots[:, i]):
            order[[k, p]] = order[[p, k]]
        rows = sizes[order]
        lower = np.tril(a[:, :, i], -1) * rows[:, None] / rows
        np.testing.assert_allclose(np.tril(wide[:, :, i], -1), lower, rtol=1e-9)
