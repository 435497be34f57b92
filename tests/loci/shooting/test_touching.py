"""Curves of orbits that touch a switching surface: nonsmooth folds in two parameters."""

import numpy as np
import pytest

import contin
from contin import api
from contin.model.model import Model


def test_circles_that_touch_a_line_lie_where_their_radius_says():
    """r' = b1 r + b2 r^3 - k r^5, k = 10 beyond x = 0.2, else 1: circles of radius 0.2 have b1 = 0.04^2 - 0.04 b2."""
    model = Model(
        "wall", states={"x": 0.4, "y": 0.0}, parameters={"b1": 0.01, "b2": 0.3, "w": 1.3},
        definitions={"r": "x^2 + y^2", "k": "10 if x > 0.2 else 1"},
        equations={"x": "b1*x - w*y + b2*x*r - x*r^2*k", "y": "w*x + b1*y + b2*y*r - y*r^2*k"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model), "b1", (-0.4, 0.3))
    (point,) = family.points  # the only one down to the Hopf point, where the section of small circles is lost
    assert point.normal_form["kind"] == "nonsmooth"
    assert point.values["b1"] == pytest.approx(-0.0104, abs=1e-11)
    assert {end.reason for end in family.ends} == {"bound", "hopf"}
    touching = api.continuation(point.locus(), ("b1", "b2"), {"b1": (-0.4, 0.3), "b2": (0.01, 1.2)})
    np.testing.assert_allclose(touching.columns["b1"], 0.0016 - 0.04 * touching.columns["b2"], atol=1e-11)
    assert [end.reason for end in touching.ends] == ["bound", "bound"]
    np.testing.assert_array_equal(touching.columns["turns"], touching.columns["b2"] > 0.08)  # there b1 falls with r
    assert touching.notes[0].startswith("the orbits touch x - 0.2 = 0: nonsmooth folds")


def fold_of(model, start, first, parameters):
    orbit = api.periodic_orbit(model, start, parameters)
    family = api.continuation(orbit, first, direction="up", settings={"steps": 90, "stop_at": ("LPC",)})
    return next(p for p in family.points if p.normal_form.get("kind") == "nonsmooth")


@pytest.mark.seldom
def test_metronomes_that_reach_the_ends_of_their_escapement_on_both_sides():
    """Amplitude x2, by symmetry at both turning points; against folds of families in alpha at other values of eps."""
    model = contin.load("metronomes/one-constant")
    point = fold_of(model, "oscillating", "alpha", {"eps": 0.02})
    box = {"alpha": (0.01, 0.2), "eps": (0.001, 0.3)}
    touching = api.continuation(point.locus(), ("alpha", "eps"), box, values={"eps": [0.1]})
    np.testing.assert_allclose(touching.columns["x.max"], 1.5, atol=1e-9)
    np.testing.assert_allclose(touching.columns["x.min"], -1.5, atol=1e-9)
    there = fold_of(model, "oscillating", "alpha", {"eps": 0.1})
    assert touching["UZ1"].values["alpha"] == pytest.approx(there.values["alpha"], abs=3e-10)
    averaged = api.continuation(point.locus(), ("alpha", "x1"), {"alpha": (0.01, 0.5), "x1": (0.4, 1.2)})
    far = abs(averaged.columns["x1"] - 0.75) > 0.02  # (r - x1)/r^2 is largest at r = 2 x1, to order eps
    np.testing.assert_array_equal(averaged.columns["turns"][far], averaged.columns["x1"][far] > 0.75)
    assert touching.columns["alpha"][np.argmin(touching.columns["eps"])] == pytest.approx(4 / 9 / np.pi, abs=1e-4)


@pytest.mark.seldom
def test_a_surface_may_be_touched_and_crossed_in_one_period():
    """The push acts between the roots 1 and 1.5 of x^2 - s x + m: one surface, crossed at 1, touched at 1.5."""
    model = Model(
        "window", states={"x": 2.2, "y": 0.0}, parameters={"alpha": 0.05, "eps": 0.05, "s": 2.5, "m": 1.5},
        definitions={"g": "1 if s*x - x^2 > m and y > 0 else 0"},
        equations={"x": "y", "y": "-x + eps*(-alpha*y + g)"},
    )  # fmt: skip

    def fold(s):
        orbit = api.periodic_orbit(model, None, {"s": s})
        family = api.continuation(orbit, "alpha", (0.02, 0.2), settings={"stop_at": ("LPC",)})
        return next(p for p in family.points if p.normal_form.get("kind") == "nonsmooth")

    box = {"alpha": (0.01, 0.2), "s": (2.46, 2.6)}
    touching = api.continuation(fold(2.5).locus(), ("alpha", "s"), box, values={"s": [2.55]})
    s = touching.columns["s"]
    np.testing.assert_allclose(touching.columns["x.max"], s / 2 + np.sqrt(s * s / 4 - 1.5), atol=1e-9)
    assert touching["UZ1"].values["alpha"] == pytest.approx(fold(2.55).values["alpha"], abs=1e-10)
