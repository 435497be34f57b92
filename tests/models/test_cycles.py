"""Cycles of the classics that have no closed form, by Fourier collocation: periods, folds and period doublings."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.model.evaluate import evaluate
from tests.models.fourier import Orbits, differentiation

# frequency of x'' - mu (1 - x^2) x' + x = 0: C. M. Andersen and J. F. Geer, SIAM J. Appl. Math. 42 (1982) 678
SERIES = (1.0, -1 / 16, 17 / 3072, 35 / 884736, -678899 / 5096079360)


# amplitude, phase lag and frequency at the folds of x = A cos(omega t - lag), by harmonic balance: first guesses
RESONANCE = [(0.591, 2.878, 1.3236), (1.689, 1.620, 1.7742)]


def settled(f, p, start, until, count):
    """A cycle by simulation: one period from a maximum of the first state; (n, count) values and the frequency."""

    def top(t, y):
        return f(np.asarray(y)[:, None], np.zeros(1), p)[0, 0]

    top.direction = -1
    done = solve_ivp(
        lambda t, y: f(y[:, None], np.zeros(1), p)[:, 0],
        (0, until),
        start,
        "DOP853",
        events=top,
        rtol=1e-9,
        dense_output=True,
    )
    begin, end = done.t_events[0][-2:]
    return done.sol(begin + (end - begin) * np.arange(count) / count), 2 * np.pi / (end - begin)


def expected(name, label):
    """The one-parameter expectation of this label that needs cycles, in numbers."""
    model = contin.load(name)
    [item] = [e for e in model.expect if e.label == label]
    values = model.default_parameters()
    return [{key: float(evaluate(v, values)) for key, v in point.items()} for point in item.at]


def van_der_pol(u, s, p):
    return np.array([u[1], (p - u[0] ** 2) * u[1] - u[0]])


def lure(u, s, p):
    return np.array([u[1], u[2], -p * u[2] - u[1] - u[0] + u[0] ** 2])


def lure_slope(u, v, p):
    return np.array([v[1], v[2], -p * v[2] - v[1] - v[0] + 2 * u[0] * v[0]])


def duffing(u, s, p):
    return np.array([u[1], 0.3 * np.cos(s) - 0.1 * u[1] - u[0] - u[0] ** 3])


def duffing_slope(u, v, p):
    return np.array([v[1], -0.1 * v[1] - v[0] - 3 * u[0] ** 2 * v[0]])


@pytest.mark.parametrize("count", [16, 17])
def test_differentiation_is_exact_for_trigonometric_polynomials(count):
    s = 2 * np.pi * np.arange(count) / count
    np.testing.assert_allclose(differentiation(count) @ np.sin(5 * s), 5 * np.cos(5 * s), atol=1e-12)


def van_der_pol_frequency(p):
    u, omega = settled(van_der_pol, p, [2.0 * np.sqrt(p), 0.0], 40.0 + 20.0 / p, 61 if p < 1 else 101)
    return Orbits(van_der_pol, lure_slope, 2, u.shape[1]).orbit(u, p, omega)[1]


def test_van_der_pol_frequency_misses_its_perturbation_series_by_the_tenth_order():
    mu = np.array([0.5, 0.7])
    misses = [abs(van_der_pol_frequency(p) - sum(c * p ** (2 * k) for k, c in enumerate(SERIES))) for p in mu]
    order = np.log(misses[1] / misses[0]) / np.log(mu[1] / mu[0])
    assert order == pytest.approx(10, abs=0.6)


def test_van_der_pol_has_the_expected_period():
    [point] = expected("van-der-pol", "UZ")
    assert 2 * np.pi / van_der_pol_frequency(point["alpha"]) == pytest.approx(point["period"], rel=1e-12)


def test_lure_cycle_doubles_its_period_where_an_antiperiodic_variation_exists():
    [point] = expected("lure", "PD")
    u, omega = settled(lure, 0.66, [0.3, 0.0, 0.0], 400.0, 41)
    p, omega = Orbits(lure, lure_slope, 3, 41).critical(u, 0.66, omega, doubling=True)
    assert p == pytest.approx(point["alpha"], rel=1e-11)
    assert 2 * np.pi / omega == pytest.approx(point["period"], rel=1e-11)


def test_duffing_response_folds_where_a_periodic_variation_exists():
    points = expected("duffing", "LPC")
    orbits = Orbits(duffing, duffing_slope, 2, 41, omega=lambda p: p)
    s = orbits.phases()
    found = []
    for amplitude, lag, guess in RESONANCE:
        u = np.array([amplitude * np.cos(s - lag), -guess * amplitude * np.sin(s - lag)])
        found.append(orbits.critical(u, guess, guess, doubling=False)[0])
    assert sorted(found) == pytest.approx(sorted(p["omega"] for p in points), rel=1e-11)
