"""The matrix of an operator known by products: few of them where most entries are zero, and none is overlooked."""

import numpy as np
import pytest
from scipy import sparse

from contin.linalg.probed import LARGEST_FULL, ProbedMatrix


class Counted:
    """v -> A v, counting."""

    def __init__(self, matrix):
        self.matrix, self.calls = matrix, 0

    def __call__(self, v):
        self.calls += 1
        return np.asarray(self.matrix @ v)


def chain(n, seed=0):
    rng = np.random.default_rng(seed)
    return sparse.diags_array([rng.normal(size=n - 1), rng.normal(size=n), rng.normal(size=n - 1)], offsets=[-1, 0, 1])


def test_a_chain_takes_three_products_and_one_that_looks():
    n = 400
    probed, sizes = ProbedMatrix(n), np.exp(np.random.default_rng(1).uniform(-20, 20, n))
    first = Counted(chain(n))
    np.testing.assert_array_equal(probed.at(first, sizes).toarray(), first.matrix.toarray())
    assert first.calls == n
    later = Counted(chain(n, seed=1))
    np.testing.assert_allclose(probed.at(later, sizes).toarray(), later.matrix.toarray(), rtol=1e-14)
    assert later.calls == 3 + 1


@pytest.mark.parametrize("size", [1.0, 1e-4, 1e-10])
def test_entries_that_appear_elsewhere_are_seen(size):
    n = 100
    probed, sizes = ProbedMatrix(n), np.ones(n)
    probed.at(Counted(chain(n)), sizes)
    more = (chain(n) + sparse.coo_array(([size], ([3], [77])), shape=(n, n))).tocsc()
    grown = Counted(more)
    np.testing.assert_allclose(probed.at(grown, sizes).toarray(), more.toarray(), atol=1e-14)
    assert grown.calls == 3 + 1 + n
    again = Counted(more)
    np.testing.assert_allclose(probed.at(again, sizes).toarray(), more.toarray(), atol=1e-14)
    assert again.calls <= 6


def test_inexact_products_are_looked_through_once():
    n = 200
    probed, matrix, rng = ProbedMatrix(n), chain(n), np.random.default_rng(4)
    calls = []
    for _ in range(6):
        inexact = Counted(matrix)
        probed.at(lambda v: inexact(v) * (1.0 + 1e-9 * rng.uniform(-1, 1, n)), np.ones(n))  # noqa: B023
        calls.append(inexact.calls)
    assert calls[:2] == [n, 4 + n]
    assert sorted(calls[2:])[:3] == [4, 4, 4]  # another one at most, where the first noise was small by chance


def test_full_matrices_take_all_products_up_to_a_size():
    full = np.random.default_rng(2).normal(size=(60, 60))
    probed = ProbedMatrix(60)
    for _ in range(2):
        product = Counted(full)
        np.testing.assert_array_equal(probed.at(product, np.ones(60)).toarray(), full)
        assert product.calls == 60
    n = LARGEST_FULL + 1
    large = ProbedMatrix(n)
    assert large.at(Counted(np.ones((n, n))), np.ones(n)) is None
    second = Counted(np.ones((n, n)))
    assert large.at(second, np.ones(n)) is None
    assert second.calls == 0
