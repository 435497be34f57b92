"""Doublings of an oscillator that hits a wall, x'' + 2 z x' + x = cos(w t), x' -> -r x' at x = 0, beside 30 digits."""

from __future__ import annotations

import math

import mpmath
import pytest

import contin


def family(z: float, r: float, bounds: tuple[float, float]) -> contin.Branch:
    model = contin.Model(
        "impacts",
        states={"x": -0.2, "v": 0.8},
        parameters={"w": 2.6, "r": r, "z": z},
        forcing={"period": "2*pi/w"},
        equations={"x": "v", "v": "-2*z*v - x + cos(w*t)"},
        events=[{"when": "x", "direction": "up", "set": {"v": "-r*v"}}],
    )
    return contin.continuation(contin.periodic_orbit(model, {"x": -0.2, "v": 0.8}), "w", bounds)


def doubling(z: float, r: float, guess: tuple[float, float, float]) -> mpmath.mpf:
    """w at which the map from impact to impact, (t, v) -> (t', v'), has the multiplier -1 at an orbit of one impact.

    guess : w, the time and the velocity after an impact. Between impacts the motion is known: with E(s) = exp(A s) of
    the free oscillator and Y(t) the forced one, u(t) = Y(t) + E(t - t0) (u0 - Y(t0)), du = E(T) (-f(u0, t0) dt0 + du0).
    """

    def free(s):
        rate = mpmath.sqrt(1 - mpmath.mpf(z) ** 2)
        c, d, fading = mpmath.cos(rate * s), mpmath.sin(rate * s) / rate, mpmath.exp(-z * s)
        return fading * mpmath.matrix([[c + z * d, d], [-d, c - z * d]])

    def forced(w, t):
        u = mpmath.exp(1j * w * t) / (1 - w * w + 2j * z * w)
        return mpmath.matrix([u.real, (1j * w * u).real])

    def equations(w, t, v):
        across, push = free(2 * mpmath.pi / w), mpmath.cos(w * t)
        x, landing = across * (mpmath.matrix([0, v]) - forced(w, t)) + forced(w, t)
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
def test_the_error_of_a_doubling_covers_that_of_the_trajectories(z, r, bounds):
    """They are computed to 1e-12: places were 1e-13 off where 1e-14 was stated."""
    point = family(z, r, bounds)["PD1"]
    w = point.values["w"]
    begun = 2.0 * math.pi / w * float(point.z[2])  # the clock counts periods
    off = abs(float(doubling(z, r, (w, begun, float(point.z[1]))) - w))
    assert off <= point.error < 1e-11
