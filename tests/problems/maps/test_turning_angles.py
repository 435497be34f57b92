"""Fixed points of maps of angles that gain full turns: equal modulo the period."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import contin
from contin.model.expression import add, number
from contin.symbolic.passes.lifted import is_lift, lifted


def ball(**start: float) -> contin.Model:
    """A bouncing ball (Holmes 1982): phase of the table and velocity, friction al, strength g."""
    return contin.Model(
        "ball", kind="map", states={"ph": {"value": start["ph"], "period": "2*pi"}, "v": start["v"]},
        parameters={"al": 0.5, "g": 4.0}, equations={"ph": "ph + v", "v": "al*v - g*cos(ph + v)"},
    )  # fmt: skip


@pytest.mark.parametrize("turns", [-1, 0, 1, 2])
def test_a_ball_that_bounces_once_in_so_many_periods_of_the_table(turns):
    """v = 2 pi k, g cos(ph) = -(1 - al) v: a fold at g = (1 - al)|v|, a doubling where g sin(ph) = -2 (1 + al)."""
    v, g = 2.0 * pi * turns, 8.0
    phase = 2.0 * pi - np.arccos(-0.5 * v / g)
    model = ball(ph=phase + 0.05, v=v + 0.1)
    point = contin.equilibrium(model, parameters={"g": g})
    np.testing.assert_allclose(point.u, [phase, v], atol=1e-12)
    branch = contin.continuation(point, "g", (1.0, 9.0))
    np.testing.assert_allclose(branch.columns["v"], v, atol=1e-12)
    double = sqrt(9.0 + (0.5 * v) ** 2)
    expected = {("PD", double)} | ({("LP", abs(0.5 * v))} if turns else set())
    assert {p.type for p in branch.points} == {type_ for type_, _ in expected}
    for type_, place in expected:
        (label,) = (p for p in branch.points if p.type == type_)
        assert abs(label.values["g"] - place) <= label.error < 1e-11
    twice = contin.continuation(branch["PD1"].switch(), "g", (1.0, 5.0)) if turns == 1 else None
    if twice is not None:  # cycles of two bounces, of which the second iterate is the state itself, two turns on
        k, g = len(twice) - 1, twice.columns["g"][-1]
        x, y = twice.columns["ph.1"][k], twice.columns["v.1"][k]
        for _ in range(2):
            x, y = x + y, 0.5 * y - g * cos(x + y)
        assert (x - twice.columns["ph.1"][k]) / (2.0 * pi) == pytest.approx(2.0, abs=1e-9)
        assert y == pytest.approx(twice.columns["v.1"][k], abs=1e-9)


@pytest.mark.parametrize("period", [1, 2])
def test_the_first_tongue_of_the_circle_map(period):
    """q' = q + w - k/(2 pi) sin(2 pi q) turns once where |w - 1| <= k/(2 pi); its second iterate turns twice there."""
    model = contin.Model(
        "circle", kind="map", states={"q": {"value": 0.05, "period": 1}}, parameters={"w": 1.01, "k": 0.5},
        equations={"q": "q + w - k/(2*pi)*sin(2*pi*q)"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model, period=period), "w", (0.5, 1.5))
    folds = sorted(p.values["w"] for p in branch.points)
    np.testing.assert_allclose(folds, [1.0 - 0.25 / pi, 1.0 + 0.25 / pi], atol=1e-12)
    assert all(p.type == "LP" for p in branch.points)
    first = branch.columns["q"] if period == 1 else branch.columns["q.1"]
    for q, w in zip(first, branch.columns["w"], strict=True):
        assert q + w - 0.25 / pi * sin(2.0 * pi * q) - 1.0 == pytest.approx(q, abs=1e-9)


def test_lifts_are_one_map_and_other_maps_are_none():
    model = ball(ph=4.0, v=6.0)
    assert is_lift(lifted(model, (1, 0)), model)
    assert is_lift(lifted(model, (-3, 0)), model)
    faster = model.replace(equations=(model.equations[0], add(model.equations[1], number(2.0 * pi))))
    assert not is_lift(faster, model)  # a velocity is no angle

