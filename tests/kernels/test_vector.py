"""Row updates and products in machine vectors, against numpy, at every remainder of rows and columns by four."""

import numpy as np
import pytest

from contin.kernels.collocation_dense import eliminate_dense, eliminate_right_dense, substitute_back_dense
from tests.kernels.small import copy, run

ROWS = """
from contin.kernels.compile import kernel
from contin.kernels.vector import add_four, multiply, subtract_four


@kernel("f2, f2, f2, i, i")
def updated(c, p, f, sign, at):
    if sign > 0:
        add_four(c, at, c.shape[1], c.shape[0] - 1, p, 0, p.shape[1], f, 0, 4, 1, p.shape[1])
    else:
        subtract_four(c, at, c.shape[1], c.shape[0] - 1, p, 0, p.shape[1], f, 0, 4, 1, p.shape[1])


@kernel("f1, i, f2, i, i, f1, i, i")
def multiplied(out, out_at, a, a_at, rows, v, v_at, columns):
    multiply(out, out_at, a, a_at, a.shape[1], rows, v, v_at, columns)
"""
CHECK = """
import numpy as np
from contin.kernels.rows import multiplied, updated

for rows in (1, 2, 3, 4, 5, 8, 11):
    for columns in (0, 1, 3, 4, 6, 7, 8, 21):
        generator = np.random.default_rng(rows + 100 * columns)
        p, f = generator.normal(size=(4, columns)), generator.normal(size=(rows, 4))
        for sign in (1, -1):
            c = generator.normal(size=(rows + 1, columns + 3))
            expected = c.copy()
            expected.ravel()[2:][np.arange(rows)[:, None] * (columns + 3) + np.arange(columns)] += sign * f @ p
            updated(c, p, f, sign, 2)
            np.testing.assert_allclose(c, expected, rtol=0, atol=1e-13)
        a, v = generator.normal(size=(rows + 1, columns + 2)), generator.normal(size=columns + 3)
        out = np.full(rows + 2, np.nan)
        multiplied(out, 1, a, columns + 3, rows, v, 2, columns)
        np.testing.assert_allclose(out[1:-1], a[1:, 1 : columns + 1] @ v[2 : columns + 2], rtol=0, atol=1e-13)
        assert np.isnan(out[[0, -1]]).all()  # nothing else is touched
print("good")
"""


def test_rows_times_factors_and_products_with_a_vector(tmp_path):
    folder = copy(tmp_path / "copy")
    (folder / "contin" / "kernels" / "rows.py").write_text(ROWS)
    assert run(folder, CHECK, cache=tmp_path / "cache")[0] == "good"


@pytest.mark.parametrize(("count", "rest"), [(1, 2), (3, 5), (4, 4), (6, 3), (9, 8), (12, 2)])
def test_elimination_forward_and_back_solves_the_block_system(count, rest):
    """[A B; C D] [x; y] = [f; g]: elimination leaves S = D - C A^-1 B and g - C A^-1 f, and x from y."""
    generator = np.random.default_rng(count)
    size, lanes = count + rest, 3
    matrices = generator.normal(size=(lanes, size, size))
    matrices[1, :count] = matrices[1, :count][::-1].copy()
    y, f = generator.normal(size=(rest, lanes)), generator.normal(size=(size, lanes))
    a, right = matrices.copy(), f.copy()
    pivots, panel, memory = np.zeros((lanes, count), np.int64), np.zeros((4, size)), np.zeros(size + 4)
    for i in range(lanes):
        sign = eliminate_dense(a, i, count, count, pivots, np.ones(count), np.ones((count, 1)), panel)
        assert sign == np.linalg.slogdet(matrices[i, :count, :count])[0]
    eliminate_right_dense(a, count, 0, lanes, pivots, right, memory)
    reduced = right[count:].copy()
    substitute_back_dense(a, count, 0, lanes, y, right, memory)
    for i in range(lanes):
        top, bottom = matrices[i, :count], matrices[i, count:]
        solved = np.linalg.solve(top[:, :count], np.column_stack([f[:count, i], top[:, count:]]))
        np.testing.assert_allclose(reduced[:, i], f[count:, i] - bottom[:, :count] @ solved[:, 0], atol=1e-9)
        schur = bottom[:, count:] - bottom[:, :count] @ solved[:, 1:]
        np.testing.assert_allclose(a[i, count:, count:], schur, atol=1e-9)
        np.testing.assert_allclose(right[:count, i], solved[:, 0] - solved[:, 1:] @ y[:, i], atol=1e-9)
