"""Extrema along branches against closed forms."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


def test_a_slaved_state():
    """x = sin p: maxima and minima with curvature -+1."""
    model = Model("s", states={"x": 0}, parameters={"p": 0}, equations={"x": "sin(p) - x"})
    line = contin.continuation(contin.equilibrium(model), "p", (-8.0, 8.0), extrema=["x"])
    points = [p for p in line.points if p.type == "EX"]
    exact = np.pi * np.array([-2.5, -1.5, -0.5, 0.5, 1.5, 2.5])
    assert len(points) == len(line.points) == 6
    for point, place in zip(points, exact, strict=True):
        assert abs(point.values["p"] - place) <= max(point.error, 1e-10)
        high = np.sin(place) > 0
        assert point.normal_form["kind"] == ("maximum" if high else "minimum")
        assert point.normal_form["curvature"] == pytest.approx(-1.0 if high else 1.0, rel=1e-5)
        assert point.normal_form["of"] == "x"


def test_an_amplitude_of_orbits_and_an_observable():
    """r^2 = p (2 - p): the largest orbit at p = 1; the observable p*r^2 on equilibria of the amplitude equation."""
    orbits = Model(
        "o", states={"x": 1, "y": 0}, parameters={"p": 1.2},
        equations={"x": "x*(p*(2 - p) - x^2 - y^2) - y", "y": "y*(p*(2 - p) - x^2 - y^2) + x"},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(orbits), "p", (0.3, 1.7), extrema=["x.max"])
    (point,) = [p for p in family.points if p.type == "EX"]
    assert abs(point.values["p"] - 1.0) < 1e-6
    assert point.values["x.max"] == pytest.approx(1.0, abs=1e-7)


def test_the_parameter_itself_turns_at_folds():
    model = Model("f", states={"x": 1}, parameters={"p": 1}, equations={"x": "p - x^2"})
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 2.0), extrema=["p"])
    assert sorted(p.type for p in line.points) == ["EX", "LP"]
    assert abs(line["EX1"].values["p"]) <= line["EX1"].error + 1e-12
