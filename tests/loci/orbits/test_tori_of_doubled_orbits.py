"""Curves of NS of doubled orbits of a flow: they end at R2 of the orbits of half the period, and do not go back.

(X, Y) = X0(t) + R(pi t) (u, v) with u' = v, v' = b1 u + b2 v - u^3 - u^2 v: odd, so that the equation in x, y has the
period 1, R has 2. u = v = 0 doubles at b1 = 0; the doubled orbits u = +-sqrt(b1) have NS on b2 = b1 with the angle
2 sqrt(2 b1) over their period 2: R4 at b1 = pi^2/32, R3 at pi^2/18. The curve comes to R2 of the orbit X0 at (0, 0).
"""

import numpy as np
import pytest

import contin

PARTS = {
    "name": "doubled", "states": {"x": 0.0, "y": 0.0}, "parameters": {"b1": -0.05, "b2": 0.1, "c": 1.0},
    "forcing": {"period": 1},
    "definitions": {
        "X": "x - c*sin(2*pi*t)", "u": "cos(pi*t)*X + sin(pi*t)*y", "v": "-sin(pi*t)*X + cos(pi*t)*y",
        "g": "b1*u + b2*v - u^3 - u^2*v",
    },
    "equations": {
        "x": "2*pi*c*cos(2*pi*t) - pi*y + cos(pi*t)*v - sin(pi*t)*g", "y": "pi*X + sin(pi*t)*v + cos(pi*t)*g",
    },
}  # fmt: skip


def _curve(c: float):
    model, times = contin.load(PARTS), np.linspace(0.0, 1.0, 41)
    orbit = np.column_stack([c * np.sin(2.0 * np.pi * times), 0.0 * times])
    start = contin.periodic_orbit(model, orbit, {"c": c}, times=times)
    line = contin.continuation(start, "b1", (-0.1, 0.1), settings={"stop_at": ("PD",)})
    doubled = contin.continuation(line["PD1"].switch(), "b1", (-0.1, 0.2), settings={"stop_at": ("NS",)})
    bounds = {"b1": (-0.5, 0.6), "b2": (-0.5, 0.6)}
    return contin.continuation(doubled["NS1"].locus(), ("b1", "b2"), bounds)


@pytest.mark.seldom
def test_a_curve_of_tori_ends_where_the_halves_of_its_orbits_come_together():
    curve = _curve(1.0)
    labels = sorted((p.type, p.values["b1"]) for p in curve.points)
    assert [type_ for type_, _ in labels] == ["R3", "R4"]
    assert [at for _, at in labels] == pytest.approx([np.pi**2 / 18, np.pi**2 / 32], abs=1e-9)
    np.testing.assert_allclose(curve.columns["b2"], curve.columns["b1"], atol=1e-8)
    assert sorted(end.reason for end in curve.ends) == ["bound", "joined"]
    assert curve.columns["b1"].min() < 2e-3


@pytest.mark.seldom
def test_a_curve_whose_orbits_shrink_to_a_point_ends():
    """X0 = 0: no step leads beyond, in whatever metric (it was asked for without end)."""
    curve = _curve(0.0)
    assert {end.reason for end in curve.ends} <= {"bound", "joined", "corrector"}
    assert sorted(p.type for p in curve.points) == ["R3", "R4"]
