"""Coefficients of boundary-value problems are off by no more than they say, the mesh's error among it."""

import numpy as np
import pytest

import contin

EPS = 0.13


@pytest.fixture(scope="module")
def flat():
    """Cahn and Hilliard's equation with a given mean."""
    parts = {
        "name": "cahn-hilliard", "kind": "bvp", "time": {"name": "t"}, "states": {"u": -0.8, "v": 0},
        "parameters": {"m": -0.8, "mu": 0.0}, "equations": {"u": "v", "v": f"(u^3 - u - mu)/{EPS**2:.17g}"},
        "conditions": ["v(start) = 0", "v(end) = 0", "mean(u) = m"],
    }  # fmt: skip
    return contin.continuation(contin.boundary_problem(contin.load(parts), free=["mu"]), "m", (-0.9, 0.9))


@pytest.mark.seldom
def test_of_pitchforks(flat):
    """u = m + e cos k t + e^2 c cos 2 k t, with K = (k eps)^2 = 1 - 3 m^2: c = -m/(2 K), m_2 = -(3/4 + 3 m c)/(6 m).

    With |q|^2 = 1 on average e^2 is 2/(1 + k^2) x^2.
    """
    assert [p.type for p in flat.points] == ["BP"] * 4
    for point, mode in zip(flat.points, (1, 2, 2, 1), strict=True):
        k = mode * np.pi
        kept = (k * EPS) ** 2
        m = np.copysign(np.sqrt((1.0 - kept) / 3.0), point.values["m"])
        assert abs(point.values["m"] - m) <= point.error
        form, exact = point.normal_form, (0.75 - 1.5 * m * m / kept) * 2.0 / (1.0 + k * k) / m
        assert abs(form["b30"] - exact) <= form["errors"]["b30"] < 1e-7
        assert abs(form["b20"]) <= form["errors"]["b20"] < 1e-9


def test_of_folds(flat):
    """Four folds that two reflections map onto each other have one coefficient, but for its sign."""
    one = contin.continuation(flat["BP1"].switch(), "m", (-0.9, 0.9))
    folds = [p.normal_form for p in one.points if p.type == "LP"]
    assert len(folds) == 4
    for form in folds[1:]:
        off = abs(abs(form["a"]) - abs(folds[0]["a"]))
        assert off <= form["errors"]["a"] + folds[0]["errors"]["a"] < 1e-9
