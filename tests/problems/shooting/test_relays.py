"""Orbits of piecewise-linear oscillators in closed form: relay, bilinear, two coupled relays, forced bilinear."""

from functools import cache
from math import cos, exp, pi, sin, sqrt

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import contin
from contin import api
from contin.model.model import Model

D, K = 0.2, 0.5


def oscillator(name, equations, states, parameters, **more):
    return Model(name, states=states, parameters=parameters, equations=equations, **more)


def test_relay_oscillator_has_the_amplitude_and_multiplier_of_its_half_turns():
    # x'' + 2 d x' + x = k sign(x'): in half a turn x - k goes from -(A + k) to (A + k) rho, rho = exp(-pi d/w)
    model = oscillator("relay", {"x": "y", "y": "-2*d*y - x + k*sign(y)"}, {"x": 1, "y": 0.1}, {"d": D, "k": K})
    branch = api.continuation(api.periodic_orbit(model), "d", (0.1, 0.5))
    assert not branch.points
    for row in (0, -1):
        d = branch.columns["d"][row]
        w = sqrt(1.0 - d * d)
        rho = exp(-pi * d / w)
        assert branch.columns["period"][row] == pytest.approx(2.0 * pi / w, rel=1e-10)
        assert branch.columns["x.max"][row] == pytest.approx(K * (1.0 + rho) / (1.0 - rho), rel=1e-9)  # at a crossing
        assert min(abs(branch.eigenvalues[row])) == pytest.approx(rho**2, rel=1e-7)


def test_bilinear_oscillator_at_a_prescribed_energy():
    # on H = E: two half turns at frequencies 1 and sqrt(1 + k); the divergence -g y^2 gives exp(-g E T)
    equations = {"x": "y", "y": "-s*x + g*(E - (y^2 + s*x^2)/2)*y"}
    model = oscillator(
        "bilinear", equations, {"x": 0.3, "y": 0.8}, {"k": 1, "E": 0.5, "g": 0.2},
        definitions={"s": "1 + k if x > 0 else 1"},
    )  # fmt: skip
    branch = api.continuation(api.periodic_orbit(model), "k", (0.0, 8.0))
    for row in (0, len(branch.columns["k"]) // 2, -1):
        k = branch.columns["k"][row]
        period = pi + pi / sqrt(1.0 + k)
        assert branch.columns["period"][row] == pytest.approx(period, rel=1e-10)
        assert branch.columns["x.max"][row] == pytest.approx(1.0 / sqrt(1.0 + k), rel=1e-9)
        assert branch.columns["x.min"][row] == pytest.approx(-1.0, rel=1e-9)
        assert min(abs(branch.eigenvalues[row])) == pytest.approx(exp(-0.1 * period), rel=1e-8)


def antisymmetric(c, sign):
    """Zero where the half-turn of the difference of two coupled relays has the eigenvalue +-1.

    q'' + 2 d q' + (1 + 2 c) q = 0 for a half turn of the sum, then q' times (A + k)/(A - k) = 1/rho: the trace is
    (1 + rho) cos theta - (1 - rho) (d/W) sin theta, theta = pi W/w, and the determinant rho.
    """
    w, fast = sqrt(1.0 - D * D), sqrt(1.0 + 2.0 * c - D * D)
    rho, theta = exp(-pi * D / w), pi * fast / w
    return (1.0 + rho) * cos(theta) - (1.0 - rho) * D / fast * sin(theta) - sign * (1.0 + rho)


def test_two_coupled_relays_branch_in_two_close_pairs_where_their_difference_says():
    roots = []
    for sign in (1.0, -1.0):
        c = np.linspace(0.2, 6.0, 4001)
        values = np.array([antisymmetric(x, sign) for x in c])
        roots += [
            brentq(antisymmetric, c[i], c[i + 1], args=(sign,), xtol=1e-14)
            for i in np.flatnonzero(values[1:] * values[:-1] < 0.0)
        ]
    assert len(roots) == 4  # two of them at 3/2 (1 - d^2) and 4 (1 - d^2), in resonance
    equations = {
        "x1": "y1", "y1": "-2*d*y1 - x1 + k*sign(y1) + c*(x2 - x1)",
        "x2": "y2", "y2": "-2*d*y2 - x2 + k*sign(y2) + c*(x1 - x2)",
    }  # fmt: skip
    model = oscillator("two", equations, {"x1": 1, "y1": 0.1, "x2": 1, "y2": 0.1}, {"d": D, "k": K, "c": 1.2})
    branch = api.continuation(api.periodic_orbit(model), "c", (1.0, 4.5))
    assert [point.type for point in branch.points] == ["BPC"] * 4
    for point, root in zip(branch.points, sorted(roots), strict=True):
        assert point.values["c"] == pytest.approx(root, abs=5e-8)
        assert abs(point.values["c"] - root) <= 2.0 * point.error


def forced_map(u, w, d=0.05, k=4.0, force=1.0):
    """Stroboscopic map of x'' + 2 d x' + (1 + k if x > 0 else 1) x = force cos(w t), and its derivative, by pieces."""

    @cache
    def turn_of(s, dt):
        return expm(np.array([[0.0, 1.0], [-s, -2.0 * d]]) * dt)

    def piece(u, t, s, dt):
        den = (s - w * w) ** 2 + (2.0 * d * w) ** 2
        a, b = force * (s - w * w) / den, 2.0 * d * w * force / den
        steady = [
            np.array([a * cos(w * q) + b * sin(w * q), w * (b * cos(w * q) - a * sin(w * q))]) for q in (t, t + dt)
        ]
        turn = turn_of(s, dt)
        return turn @ (u - steady[0]) + steady[1], turn

    t, matrix, u = 0.0, np.eye(2), np.array(u)
    while t < 2.0 * pi / w - 1e-12:
        up = u[0] > 1e-12 or (abs(u[0]) <= 1e-12 and u[1] > 0.0)
        s, step = (1.0 + k if up else 1.0), min(0.1, 2.0 * pi / w - t)
        end, turn = piece(u, t, s, step)
        if (end[0] < 0.0) == up and abs(end[0]) > 1e-13:
            step = brentq(lambda q, u=u, t=t, s=s: piece(u, t, s, q)[0][0], 1e-9, step, xtol=1e-15)
            end, turn = piece(u, t, s, step)
            end[0] = 0.0
        t, u, matrix = t + step, end, turn @ matrix
    return u, matrix


def test_forced_bilinear_oscillator_doubles_its_period_where_exact_pieces_say():
    equations = {"x": "y", "y": "-2*d*y - x*(1 + k if x > 0 else 1) + F*cos(w*t)"}
    model = oscillator(
        "forced", equations, {"x": 0, "y": 0}, {"w": 2.1, "d": 0.05, "k": 4, "F": 1}, forcing={"period": "2*pi/w"}
    )
    branch = api.continuation(api.periodic_orbit(model), "w", (2.1, 2.5))
    assert [point.type for point in branch.points] == ["PD"]
    found = branch["PD1"]

    def singular(w):
        u = found.z[:2]
        for _ in range(3):
            end, matrix = forced_map(u, w)
            u = u + np.linalg.solve(matrix - np.eye(2), u - end)
        matrix = forced_map(u, w)[1]
        return 1.0 + np.trace(matrix) + np.linalg.det(matrix)

    w = found.values["w"]
    assert singular(w - 1e-9) * singular(w + 1e-9) < 0.0


def test_a_family_that_closes_on_a_corner_ends_there():
    # near rest x/(1 + x^2) is x: half a turn is two linear pieces, and orbits shrink where together they keep |x|
    eps = 0.04

    def growth(alpha):
        free, pushed = (np.array([[0.0, 1.0], [-1.0 + push, -eps * alpha]]) for push in (0.0, eps))
        t = brentq(lambda t: (expm(free * t) @ [1.0, 0.0])[0], 1.0, 2.0, xtol=1e-15)
        u = expm(free * t) @ [1.0, 0.0]
        s = brentq(lambda s: (expm(pushed * s) @ u)[1], 1.0, 2.2, xtol=1e-15)
        return -(expm(pushed * s) @ u)[0] - 1.0, 2.0 * (t + s)

    exact = brentq(lambda alpha: growth(alpha)[0], 0.2, 0.5, xtol=1e-14)
    orbit = api.periodic_orbit(contin.load("metronomes/one-linear-rational"), "oscillating", {"eps": eps, "alpha": 0.3})
    branch = api.continuation(orbit, "alpha", (0.29, 0.5))
    assert not branch.points
    end = next(e for e in branch.ends if e.reason == "hopf")
    assert end.data["at"]["alpha"] == pytest.approx(exact, abs=1e-9)
    assert abs(end.data["at"]["alpha"] - exact) <= 10.0 * end.data["error"]
    assert branch.columns["period"][branch.columns["x.max"] < 1e-9] == pytest.approx([growth(exact)[1]], abs=1e-8)
    assert exact == pytest.approx(1.0 / pi, abs=0.1 * eps)  # the averaged value, with an error of the order eps
