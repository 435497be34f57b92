"""The deepest place of a region is inside it, away from its border and holes: there its name stands."""

import numpy as np
import pytest

from contin.linalg.polygons import GRID, deepest

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_the_middle_of_a_square_is_farthest_from_its_sides():
    centre, depth = deepest([SQUARE])
    np.testing.assert_allclose(centre, 0.5, atol=1 / GRID)
    assert depth == pytest.approx(0.5, abs=1 / GRID)


def test_a_hole_is_avoided():
    """A square hole beside the left side: the largest disc is in a corner at the right, touching two sides and it."""
    hole = np.array([[0.0, 0.2], [0.6, 0.2], [0.6, 0.8], [0.0, 0.8]])
    centre, depth = deepest([SQUARE, hole])
    # centre (1 - r, r) and a corner (0.6, 0.2) of the hole at distance r
    r = np.roots([1.0, -1.2, 0.2]).min()
    assert depth == pytest.approx(max(r, 0.2), abs=1 / GRID)
    assert centre[0] > 0.6


def test_rings_without_an_inside_have_no_place():
    assert deepest([np.array([[0.0, 0.0], [1.0, 1.0]])]) is None


def test_a_name_stands_in_what_is_seen_of_a_region():
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    window = np.array([[8.0, -5.0], [20.0, 20.0]])
    centre, depth = deepest([square], window)
    np.testing.assert_allclose(centre[0], 9.0, atol=0.1)
    assert 0.8 < depth <= 1.0
    assert deepest([square], window + 20.0) is None
