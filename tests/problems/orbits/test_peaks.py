"""Extrema of piecewise polynomials: against dense sampling, where the peak does not stand beside the extreme node."""

import numpy as np
import pytest

from contin.kernels.collocation_basis import basis, interpolation
from contin.problems.orbits.mesh.peaks import extrema


@pytest.mark.parametrize("m", [2, 3, 4, 5, 7])
def test_extrema_are_those_of_the_polynomials(m):
    rng = np.random.default_rng(m)
    values = rng.standard_normal((20, 6 * m + 1, 3))  # rough: the polynomials rise far above their nodes
    low, high = extrema(values, m)
    fine = interpolation(m, np.linspace(0.0, 1.0, 20001))
    pieces = values[:, (np.arange(6) * m)[:, None] + np.arange(m + 1)]
    dense = np.einsum("tj,rnjk->rktn", fine, pieces).reshape(20, 3, -1)
    assert np.all(high > dense.max(axis=2) - 1e-13)
    assert np.all(high - dense.max(axis=2) < 1e-6)
    assert np.all(low < dense.min(axis=2) + 1e-13)
    assert np.all(dense.min(axis=2) - low < 1e-6)


def test_the_highest_peak_may_be_far_from_the_highest_node():
    """Two parabolas: the top 1 of the first lies between nodes, the top .999 of the second on a node."""
    nodes = basis(2).nodes
    between = float(nodes[1]) / 2.0
    first = 1.0 - np.square(nodes - between)
    second = 0.999 - np.square(nodes - nodes[1])
    for pieces in ((first, second), (second, first)):
        values = np.concatenate([pieces[0], np.linspace(pieces[0][-1], pieces[1][0], 3)[1:], pieces[1][1:]])
        low, high = extrema(values[None, :, None], 2)
        assert high[0, 0] == pytest.approx(1.0, abs=1e-15)
        assert low[0, 0] == pytest.approx(min(first.min(), second.min()), abs=1e-15)


def test_what_has_no_value_at_a_node_has_no_extrema():
    values = np.random.default_rng(1).standard_normal((3, 9, 2))
    expected = extrema(values, 4)
    values[1, 5, 0] = np.nan
    for found, before in zip(extrema(values, 4), expected, strict=True):
        assert np.isnan(found[1, 0])
        found[1, 0] = before[1, 0]
        np.testing.assert_array_equal(found, before)
