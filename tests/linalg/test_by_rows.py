"""Products by rows are those of scipy, of one matrix after another."""

import numpy as np
import scipy.sparse as sp

from contin.linalg.by_rows import ByRows
from contin.machine.threads import PART


def test_products_by_rows_are_those_by_columns_for_any_pattern_and_entries():
    n, maker, generator = PART + 5, ByRows(), np.random.default_rng(1)
    x = generator.normal(size=n)
    banded = sp.diags(generator.normal(size=(3, n)), [-7, 0, 100], shape=(n, n)).tocsc()
    skew = sp.diags(generator.normal(size=(3, n)), [-1, 0, 3], shape=(n, n)).tocsc()  # an odd number of entries
    empty = (sp.diags(np.where(np.arange(n) % 2, 1.0, 0.0)) @ banded).tocsc()
    empty.eliminate_zeros()
    for matrix in (banded, 2.0 * banded, skew, empty, banded):
        np.testing.assert_allclose(maker.product(matrix)(x), matrix @ x, rtol=1e-13, atol=1e-13)


def test_a_product_belongs_to_its_matrix_when_others_were_made_since():
    n, maker = PART + 1, ByRows()
    one, other = (sp.eye(n, format="csc") * factor for factor in (2.0, 3.0))
    first, second = maker.product(one), maker.product(other)
    x = np.ones(n)
    assert (first(x)[7], second(x)[7]) == (2.0, 3.0)
