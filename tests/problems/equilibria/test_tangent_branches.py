"""Branches that touch: kind, order of contact, exchange of stability, and both branches followed."""

import numpy as np
import pytest

import contin
from tests.problems.follow import follow

R = (-0.5, 0.6)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_contact_with_a_power_of_the_parameter(order):
    """-x (x - p^m): f_x = p^m on x = 0, so stability changes for odd m only; the other branch is x = p^m."""
    branch = follow({"x": f"-x*(x - p^{order})"}, {"x": 0.0}, {"p": R[0]}, R)
    (point,) = branch.points
    assert (point.type, point.normal_form["kind"], point.normal_form["contact"]) == ("BP", "tangency", order)
    assert abs(point.values["p"]) <= point.error
    counts = branch.columns["unstable"]
    assert (counts[0] == counts[-1]) == (order % 2 == 0)
    other = contin.continuation(point.switch(), "p", R)
    np.testing.assert_allclose(other.columns["x"], other.columns["p"] ** order, atol=1e-7)
    assert {round(p, 9) for p in other.columns["p"][[0, -1]]} == set(R)


@pytest.mark.parametrize("order", [2, 3])
def test_the_curved_branch_stays_on_its_own_sheet(order):
    branch = follow({"x": f"-x*(x - p^{order})"}, {"x": R[0] ** order}, {"p": R[0]}, R)
    assert [p.type for p in branch.points] == ["BP"]
    np.testing.assert_allclose(branch.columns["x"], branch.columns["p"] ** order, atol=1e-7)


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-7])
def test_an_imperfect_crossing_is_no_branch_point(gap):
    """x^2 = p^2 + gap^2: the branch x > 0 does not change over to x < 0."""
    branch = follow({"x": "x^2 - p^2 - d"}, {"x": np.hypot(0.5, gap)}, {"p": R[0], "d": gap**2}, R)
    assert branch.points == ()
    assert branch.columns["x"].min() > 0.0
