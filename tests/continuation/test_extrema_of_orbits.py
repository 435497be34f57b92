"""Extrema of columns of x'' + 2 z x' + x = cos w t, whose amplitude is g^(-1/2), g = (1 - w^2)^2 + 4 z^2 w^2."""

import numpy as np
import pytest

import contin

Z = 0.2
MODEL = contin.Model(
    "resonance", states={"x": 0.5, "y": 0}, parameters={"w": 0.7, "z": Z}, forcing={"period": "2*pi/w"},
    equations={"x": "y", "y": "-x - 2*z*y + cos(w*t)"},
)  # fmt: skip
IN_PHASE = "mean(x*cos(w*t))"  # (1 - w^2)/(2 g): largest at w^2 = 1 - 2 z, smallest at 1 + 2 z


@pytest.fixture(scope="module")
def start():
    return contin.periodic_orbit(MODEL, {"x": 0.5, "y": 0})


@pytest.fixture(scope="module")
def branch(start):
    return contin.continuation(start, "w", (0.65, 1.1), extrema=["x.max", "y.max", IN_PHASE])


def test_curvatures_hold_to_their_errors(branch):
    g2 = 12 * (1 - 2 * Z**2) - 4 + 8 * Z**2  # g'' at w^2 = 1 - 2 z^2
    u = 1 - 2 * Z
    exact = {
        "x.max": (np.sqrt(1 - 2 * Z**2), -0.5 * g2 * (4 * Z**2 * (1 - Z**2)) ** -1.5),
        "y.max": (1.0, -4.0 / (8 * Z**3)),
        IN_PHASE: (np.sqrt(u), -u / (8 * Z**3 * (1 - Z) ** 2)),  # 1/(2 (s + 4 z^2/s - 4 z^2)), s = 1 - w^2
    }
    assert sorted(p.normal_form["of"] for p in branch.points) == sorted(exact)
    for point in branch.points:
        form = point.normal_form
        place, curvature = exact[form["of"]]
        assert abs(point.values["w"] - place) <= point.error
        assert abs(form["curvature"] - curvature) <= form["errors"]["curvature"]
        assert form["errors"]["curvature"] < 3e-3 * abs(curvature)


def test_a_column_that_is_zero_is_not_looked_into(start, monkeypatch):
    """mean(x y) is that of a derivative: its slopes have the signs of rounding, and each had a look of its own."""
    calls = []
    probe = type(start.seed("w").problem).probe
    monkeypatch.setattr(type(start.seed("w").problem), "probe", lambda *a, **k: calls.append(1) or probe(*a, **k))
    found = contin.continuation(start, "w", (0.65, 0.75), extrema=["mean(x*y)"])
    assert not found.points
    assert not found.notes
    assert len(calls) <= 100


@pytest.mark.parametrize("column", [IN_PHASE, "amplitude"])
@pytest.mark.seldom
def test_extrema_of_formulas_and_standard_columns_are_followed(start, column):
    bounds = (0.72, 0.82) if column == IN_PHASE else (0.9, 1.0)
    begin = start if column == IN_PHASE else contin.periodic_orbit(MODEL, {"x": 0.5, "y": 0}, {"w": 0.94})
    point = contin.continuation(begin, "w", bounds if column != IN_PHASE else (0.68, 0.82), extrema=[column])["EX1"]
    curve = contin.continuation(point.locus(("w", "z")), ("w", "z"), {"w": (0.5, 1.2), "z": (0.19, 0.21)})
    w, z = curve.columns["w"], curve.columns["z"]
    exact = 1 - 2 * z if column == IN_PHASE else 1 - 2 * z**2
    assert np.allclose(w**2, exact, atol=1e-6)
    assert column in curve.columns
