"""Cycles of piecewise linear flows that shrink in proportion to the parameter onto an equilibrium at a corner."""

from __future__ import annotations

import pytest

import contin


def test_a_cycle_of_two_foci_shrinks_to_the_equilibrium_where_they_meet():
    """x' = -y + t x, y' = x - mu with t = -0.8 for x < 0, 0.3 for x > 0: a scale of x, y and mu changes nothing."""
    model = contin.Model(
        "foci", states={"x": 2, "y": 0}, parameters={"mu": 1},
        equations={"x": "-y + (-0.8*x if x < 0 else 0.3*x)", "y": "x - mu"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "mu", (-1.0, 1.5))
    first, last = branch.ends
    assert (first.reason, last.reason) == ("hopf", "bound")
    assert abs(first.data["at"]["mu"]) <= max(first.data["error"], 1e-12)
    mu, period = branch.columns["mu"][1:], branch.columns["period"][1:]
    assert period == pytest.approx(period[-1], rel=1e-8)
    assert branch.columns["x.max"][1:] / mu == pytest.approx(branch.columns["x.max"][-1] / mu[-1], rel=1e-7)
    assert branch.steps < 100


def test_a_family_between_two_corners_has_two_ends_and_is_no_closed_loop():
    """A saturated oscillator: its equilibrium x = mu is an unstable focus for |mu| < 1 and a stable one beyond."""
    model = contin.Model(
        "saturated", states={"x": 1, "y": 0}, parameters={"mu": 0.2},
        equations={"x": "y + 1.5*x if abs(x) < 1 else (y + 1.5 - 3*(x - 1) if x > 0 else y - 1.5 - 3*(x + 1))",
                   "y": "mu - x"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "mu", (-1.5, 1.5))
    assert [end.reason for end in branch.ends] == ["hopf", "hopf"]
    for end, at in zip(branch.ends, (-1.0, 1.0), strict=True):
        assert abs(end.data["at"]["mu"] - at) <= max(10.0 * end.data["error"], 1e-10)
    assert not branch.points
