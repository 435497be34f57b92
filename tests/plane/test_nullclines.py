"""Nullclines of products, along the edge of the window, double roots, poles, and what no contour shows."""

import numpy as np

import contin

UNIT = {"x_range": (-1, 1), "y_range": (-1, 1)}


def plane(x, y, **window):
    model = contin.Model(name="m", states={"x": 0.5, "y": 0.3}, parameters={"a": 1.0}, equations={"x": x, "y": y})
    return contin.plane(model, "x", "y", **window)


def test_the_axes_of_a_predator_prey_plane_are_nullclines_on_the_edge_of_the_window():
    found = plane("x*(a - y)", "y*(x - a)", x_range=(0, 4), y_range=(0, 4))
    for k, curves in enumerate(found.nullclines):  # x = 0 and y = 1; y = 0 and x = 1
        edge, inner = sorted(curves, key=lambda c: np.ptp(c[:, k]))
        np.testing.assert_allclose(edge[:, k], 0.0, atol=1e-15)
        assert np.ptp(edge[:, 1 - k]) >= 4.0
        np.testing.assert_allclose(inner[:, 1 - k], 1.0, atol=1e-12)
        assert np.ptp(inner[:, k]) >= 4.0
    assert not [note for note in found.notes if "nullcline" in note]


def test_a_double_root_is_a_nullcline_and_a_pole_is_none():
    found = plane("x^2*y", "1/x - 2*a", **UNIT)
    (apart,) = found.nullclines[1]
    np.testing.assert_allclose(apart[:, 0], 0.5, atol=1e-12)
    double, across = sorted(found.nullclines[0], key=lambda c: np.ptp(c[:, 0]))
    np.testing.assert_allclose(double[:, 0], 0.0, atol=1e-15)
    np.testing.assert_allclose(across[:, 1], 0.0, atol=1e-15)


def test_a_tangency_that_no_contour_shows_is_a_note():
    found = plane("1 - 2*x + x^2", "-y", x_range=(0, 3.1), y_range=(-1, 1))
    assert any("without a change of sign" in note for note in found.notes)
