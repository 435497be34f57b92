"""Orbits of piecewise-linear oscillators in closed form: relay, bilinear, two coupled relays, forced bilinear."""

from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import contin
from contin import api
from contin.model.model import Model
from tests.problems.shooting.oscillators import forced_family, forced_orbit, half_turn, relays_in_phase

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
    """Zero where the half-turn of the difference of two coupled relays has the eigenvalue +-1."""
    trace, determinant = half_turn(c, D)
    return trace - sign * (1.0 + determinant)


@pytest.mark.seldom
def test_two_coupled_relays_branch_in_two_close_pairs_where_their_difference_says():
    roots = []
    for sign in (1.0, -1.0):
        c = np.linspace(0.2, 6.0, 401)
        values = np.array([antisymmetric(x, sign) for x in c])
        roots += [
            brentq(antisymmetric, c[i], c[i + 1], args=(sign,), xtol=1e-14)
            for i in np.flatnonzero(values[1:] * values[:-1] < 0.0)
        ]
    assert len(roots) == 4  # two of them at 3/2 (1 - d^2) and 4 (1 - d^2), in resonance
    branch = relays_in_phase("c", 1.0, 4.5, c=1.2)
    assert [point.type for point in branch.points] == ["BPC"] * 4
    for point, root in zip(branch.points, sorted(roots), strict=True):
        assert point.values["c"] == pytest.approx(root, abs=5e-8)
        assert abs(point.values["c"] - root) <= 2.0 * point.error


def test_forced_bilinear_oscillator_doubles_its_period_where_exact_pieces_say():
    branch = forced_family()
    assert [point.type for point in branch.points] == ["PD"]
    found = branch["PD1"]
    below, above = (forced_orbit(found.z[:2], found.values["w"] + side)[1] for side in (-1e-9, 1e-9))
    assert below * above < 0.0


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


@pytest.mark.seldom
def test_a_biased_relay_stops_where_the_equilibrium_of_one_side_arrives_at_its_surface():
    """(s + 1)(s + 2)(s + 3) x = 6 (b - sign x): the equilibrium x = b - 1 of x > 0 is on x = 0 at b = 1.

    The orbit passes beside it as exp(-t), and comes back as soon as x < 0: its period grows as -2 log(1 - b)/3 or so.
    """
    model = contin.Model(
        "biased", states={"x": 0.02, "y": 0.1, "z": 0}, parameters={"b": 0.9},
        equations={"x": "y", "y": "z", "z": "-6*x - 11*y - 6*z - 6*sign(x) + 6*b"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "b", (0.89, 1.2))
    end = branch.ends[1]
    assert end.reason == "surface"
    assert end.data["surface"] == "x = 0"
    assert end.data["at"]["b"] == pytest.approx(1.0, abs=1e-12)
    assert np.all(np.diff(branch.columns["period"]) > 0.0)


@pytest.mark.seldom
def test_cycles_that_come_to_an_equilibrium_on_a_corner_name_its_parameter_to_rounding():
    """v' = f(v) - w + I, w' = (v - w/2)/5, f of three pieces: the equilibrium is at v = 1/2 for I = 3/2, at 1 for 2."""
    model = contin.Model(
        "pieces", states={"v": 0.2, "w": 1.3}, parameters={"I": 1.75},
        equations={"v": "(-v if v < 0.5 else (v - 1 if v < 1 else 1 - v)) - w + I", "w": "(v - w/2)/5"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "I", (1.0, 2.5))
    assert [end.reason for end in branch.ends] == ["surface", "surface"]
    assert [end.data["at"]["I"] for end in branch.ends] == pytest.approx([1.5, 2.0], abs=1e-13)
