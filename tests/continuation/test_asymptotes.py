"""Branches that come ever nearer to a bound of the parameter, and branches that only turn there."""

import pytest

import contin


def follow(equation, x, p, bounds, **settings):
    model = contin.Model("m", states={"x": x}, parameters={"p": p}, equations={"x": equation})
    return contin.continuation(contin.equilibrium(model), "p", bounds, settings=settings)


def test_a_state_that_grows_for_ever_while_the_parameter_tends_to_its_bound_ends_there():
    """p = x exp(-x): fold at x = 1, p = 1/e, then p -> 0 as x grows."""
    line = follow("p*exp(x) - x", 0.0, 0.0, (0, 4))
    assert [end.reason for end in line.ends] == ["bound", "bound"]
    assert line.ends[1].text == "p approaches 0 ever more closely"
    assert [point.type for point in line.points] == ["LP"]
    assert line.points[0].values["p"] == pytest.approx(0.36787944117144233, abs=1e-12)
    assert line.steps < 120
    assert 0 < line.columns["p"][-1] < 4e-10


def test_a_fold_on_the_bound_is_passed():
    """p = x^2 turns at p = 0, the bound: both halves are one branch."""
    line = follow("p - x^2", 1.0, 1.0, (0, 1))
    assert [point.type for point in line.points] == ["LP"]
    assert sorted(x for x in line.columns["x"][[0, -1]]) == pytest.approx([-1, 1])
