"""The drawn spline: through every row, close to the curve that the rows are of, no rounding of corners."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from contin.plot.smooth import PARTS, smooth


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=1, max_size=30))
def test_the_spline_passes_through_every_row(rows):
    x, y = np.array(rows, float).T
    drawn = np.stack(smooth(x, y, (18.0, 18.0)), axis=1)
    assert np.isfinite(drawn).all()
    for row in np.stack([x, y], axis=1):
        assert np.min(np.abs(drawn - row).max(axis=1)) < 1e-12


def test_it_is_closer_to_a_circle_by_orders_than_the_polygon():
    def miss(count):
        angle = np.linspace(0, np.pi, count)
        x, y = smooth(np.cos(angle), np.sin(angle), (2.0, 1.0))
        inner = slice(PARTS, -PARTS)  # the end segments have a neighbour on one side only
        return np.max(np.abs(np.hypot(x, y)[inner] - 1))

    assert miss(15) < 0.2 * (1 - np.cos(np.pi / 28))  # the polygon misses by 1 - cos(half a step)
    assert np.log2(miss(15) / miss(29)) > 2.5


def test_a_corner_stays_a_corner():
    x = np.linspace(-1, 1, 11)
    drawn = np.stack(smooth(x, np.abs(x), (1.0, 1.0)), axis=1)
    np.testing.assert_allclose(drawn[:, 1], np.abs(drawn[:, 0]), atol=1e-12)


def test_fine_rows_are_left_as_they_are():
    x = np.linspace(0, 1, 2000)
    assert smooth(x, x**2, (1.0, 1.0))[0] is x
