"""An oscillator that hits a wall, x'' + 2 z x' + x = cos(w t), x' -> -r x' at x = 0, beside 30 digits."""

from __future__ import annotations

import math

import mpmath
import pytest

import contin


def family(z: float, r: float, bounds: tuple[float, float], values=None) -> contin.Branch:
    model = contin.Model(
        "impacts",
        states={"x": -0.2, "v": 0.8},
        parameters={"w": 2.6, "r": r, "z": z},
        forcing={"period": "2*pi/w"},
        equations={"x": "v", "v": "-2*z*v - x + cos(w*t)"},
        events=[{"when": "x", "direction": "up", "set": {"v": "-r*v"}}],
    )
    return contin.continuation(contin.periodic_orbit(model, {"x": -0.2, "v": 0.8}), "w", bounds, values=values)


def free(z, s):
    """exp(A s) of the free oscillator."""
    rate = mpmath.sqrt(1 - mpmath.mpf(z) ** 2)
    c, d, fading = mpmath.cos(rate * s), mpmath.sin(rate * s) / rate, mpmath.exp(-z * s)
    return fading * mpmath.matrix([[c + z * d, d], [-d, c - z * d]])


def moved(z, w, t, v, s):
    """Position and velocity a time s after an impact at the time t that the mass leaves with the velocity v."""

    def forced(t):
        u = mpmath.exp(1j * w * t) / (1 - w * w + 2j * z * w)
        return mpmath.matrix([u.real, (1j * w * u).real])

    return free(z, s) * (mpmath.matrix([0, v]) - forced(t)) + forced(t + s)


def doubling(z: float, r: float, guess: tuple[float, float, float]) -> mpmath.mpf:
    """w at which the map from impact to impact, (t, v) -> (t', v'), has the multiplier -1 at an orbit of one impact.

    guess : w, the time and the velocity after an impact. Between impacts the motion is known, and varies by
    du = exp(A T) (-f(u0, t0) dt0 + du0).
    """

    def equations(w, t, v):
        across, push = free(z, 2 * mpmath.pi / w), mpmath.cos(w * t)
        x, landing = moved(z, w, t, v, 2 * mpmath.pi / w)
        change = across * mpmath.matrix([[-v, 0], [2 * z * v - push, 1]])
        later = [-change[0, j] / landing for j in range(2)]
        faster = [-r * (change[1, j] + (push - 2 * z * landing) * later[j]) for j in range(2)]
        return [x, -r * landing - v, (1 + later[0]) * (1 + faster[1]) - later[1] * faster[0]]

    with mpmath.workdps(30):
        return mpmath.findroot(equations, guess, tol=1e-22)[0]


@pytest.mark.parametrize(
    ("z", "r", "bounds"),
    [(0.1, 0.8, (2.4, 2.9)), (0.05, 0.7, (2.4, 2.9)), (0.2, 0.9, (2.4, 2.9)), (0.3, 0.8, (2.4, 2.9))],
)
@pytest.mark.seldom
def test_the_error_of_a_doubling_covers_that_of_the_trajectories(z, r, bounds):
    """They are computed to 1e-12: places were 1e-13 off where 1e-14 was stated."""
    point = family(z, r, bounds)["PD1"]
    w = point.values["w"]
    begun = 2.0 * math.pi / w * float(point.z[2])  # the clock counts periods
    off = abs(float(doubling(z, r, (w, begun, float(point.z[1]))) - w))
    assert off <= point.error < 1e-11


@pytest.mark.parametrize(
    ("column", "value", "when", "is_extremum"),
    [
        ("x.min", -0.65, 1.25, lambda x, v, push: (x, v)),
        ("v.max", 0.6, 1.8, lambda x, v, push: (v, push - 0.2 * v - x)),
    ],
)
@pytest.mark.seldom
def test_the_error_of_a_user_value_covers_that_of_the_trajectories(column, value, when, is_extremum):
    """w at which the extremum between impacts has the value, z = .1, r = .8: 5e-13 off where 1e-15 was stated."""
    z, r = 0.1, 0.8

    def equations(w, t, v, s):
        x, landing = moved(z, w, t, v, 2 * mpmath.pi / w)
        high, slope = is_extremum(*moved(z, w, t, v, s), mpmath.cos(w * (t + s)))
        return [x, -r * landing - v, high - mpmath.mpf(str(value)), slope]

    (point,) = (p for p in family(z, r, (2.5, 2.9), {column: [value]}).points if p.type == "UZ")
    w = point.values["w"]
    guess = (w, 2.0 * math.pi / w * float(point.z[2]), float(point.z[1]), when)
    with mpmath.workdps(30):
        off = abs(float(mpmath.findroot(equations, guess, tol=1e-22)[0] - w))
    assert off <= point.error < 1e-10
