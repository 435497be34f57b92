"""Closed curves of special orbits: followed once round, also where the mesh changes on the way."""

import numpy as np
import pytest

import contin
from tests.problems.follow import model


@pytest.fixture(scope="module")
def family():
    """|w|^2 = s: orbits where (s - 1)^2 = p^2 + q^2 - 1/4, so that their folds are on a circle of radius 1/2."""
    growth = "(p^2 + q^2 - 1/4 - (x^2 + y^2 - 1)^2)"
    form = model({"x": f"x*{growth} - y", "y": f"y*{growth} + x"}, {"x": 1.0, "y": 0.0}, {"p": 0.9, "q": 0.1})
    return contin.continuation(contin.periodic_orbit(form, {"x": 1.2, "y": 0.0}), "p", (0.0, 1.0))


def test_a_closed_curve_of_folds_ends_where_it_began(family):
    curve = contin.continuation(family["LPC1"].locus(), ("p", "q"), {"p": (-1, 1), "q": (-1, 1)})
    p, q = curve.columns["p"], curve.columns["q"]
    assert [end.reason for end in curve.ends] == ["closed", "closed"]
    np.testing.assert_allclose(np.hypot(p, q), 0.5, atol=1e-9)
    np.testing.assert_allclose(curve.z[-1, -2:], curve.z[0, -2:], atol=1e-9)
    angle = np.unwrap(np.arctan2(q, p))
    assert abs(angle[-1] - angle[0]) == pytest.approx(2 * np.pi, abs=1e-8)  # once


def test_a_curve_that_leaves_the_box_before_it_is_back_is_not_closed(family):
    curve = contin.continuation(family["LPC1"].locus(), ("p", "q"), {"p": (-0.4, 1), "q": (-1, 1)})
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
