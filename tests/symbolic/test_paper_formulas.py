"""Every averaged formula of Kato and Kori, as printed, against the one the pass derives (table in docs/averaging.md).

Printed formulas are in t, so they carry a factor eps; the derived ones are in eps t. The pass's S and C are the paper's
g1 and g2 with bars.
"""

import math

import numpy as np
import pytest

import contin
from contin.model.evaluate import evaluate, evaluate_all

pi, log, sqrt = math.pi, math.log, math.sqrt


def model_i(r, alpha, x1, x2):
    if r < x1:
        return -alpha * r / 2, 0.0
    if r < x2:
        return -alpha * r / 2 + (1 - x1 / r) / pi, -sqrt(1 - x1**2 / r**2) / pi
    return -alpha * r / 2 + (x2 - x1) / (pi * r), -(sqrt(1 - x1**2 / r**2) - sqrt(1 - x2**2 / r**2)) / pi


def model_ii(r, alpha):
    turn = -(1 - sqrt((1 + sqrt(1 + r**4)) / (2 * (1 + r**4)))) / (2 * r)
    return -alpha * r / 2 + log(1 + r**4) / (4 * pi * r), turn


def model_iii(r, alpha, a, b):
    return (-6 * pi * alpha * r + 3 * a * r**3 - 2 * b * r**5) / (12 * pi), -(3 * a / 16 * r**3 - 5 * b / 32 * r**5)


def model_linear(r, alpha):
    return -alpha * r / 2 + log(1 + r**2) / (2 * pi * r), -(1 - 1 / sqrt(1 + r**2)) / (2 * r)


PRINTED = [
    ("metronomes/one-constant", model_i, {"alpha": 0.13, "x1": 0.9, "x2": 1.7}),
    ("metronomes/one-rational", model_ii, {"alpha": 0.13}),
    ("metronomes/one", model_iii, {"alpha": 0.13, "a": 3.3, "b": 0.8}),
    ("metronomes/one-linear-rational", model_linear, {"alpha": 0.13}),
]


@pytest.mark.parametrize(("name", "printed", "parameters"), PRINTED)
def test_amplitude_and_phase_of_one_metronome_as_printed(name, printed, parameters):
    averaged = contin.average(contin.load(name))
    for r in (0.3, 0.89, 1.2, 1.69, 1.75, 4.0):
        env = {**averaged.default_parameters(parameters), "r": r}
        growth, turn = printed(r, **parameters)
        assert evaluate(averaged.equations[0], env) == pytest.approx(growth, rel=1e-12, abs=1e-14)
        assert r * evaluate(averaged.observables["frequency_shift"], env) == pytest.approx(turn, rel=1e-11, abs=1e-14)


def test_two_metronomes_as_printed():
    averaged = contin.average(contin.load("metronomes/pair"))
    mu, beta, a, b = 2.3, 0.4, 3.3, 0.8
    for r1, r2, psi in ((1.2, 0.7, 0.4), (0.3, 2.4, -2.0)):
        printed = [
            (-6 * pi * mu * r2 * math.sin(psi) - 6 * pi * beta * r1 + 3 * a * r1**3 - 2 * b * r1**5) / (12 * pi),
            (6 * pi * mu * r1 * math.sin(psi) - 6 * pi * beta * r2 + 3 * a * r2**3 - 2 * b * r2**5) / (12 * pi),
            (16 * mu * (r1 / r2 - r2 / r1) * math.cos(psi) + 6 * a * (r1**2 - r2**2) - 5 * b * (r1**4 - r2**4)) / 32,
        ]
        env = averaged.default_parameters({"mu": mu, "beta": beta, "a": a, "b": b}) | {"r1": r1, "r2": r2, "psi": psi}
        np.testing.assert_allclose(evaluate_all(averaged.equations, env), printed, rtol=1e-12)


@pytest.mark.parametrize("name", ["one", "one-constant", "one-rational", "one-linear-rational", "pair"])
def test_bundled_averaged_models_are_the_derived_ones(name):
    derived, bundled = contin.average(contin.load(f"metronomes/{name}")), contin.load(f"metronomes/{name}-averaged")
    assert derived.state_names == bundled.state_names
    chance = np.random.default_rng(1)
    for _ in range(5):
        values = bundled.default_parameters() | dict(
            zip(bundled.state_names, chance.uniform(0.2, 3.0, len(bundled.states)), strict=True)
        )
        env = {"eps": 0.01, "sigma": 0.0, **values}
        np.testing.assert_allclose(
            evaluate_all(derived.equations, env), evaluate_all(bundled.equations, env), rtol=1e-11, atol=1e-14
        )


def test_the_supplements_slip_in_case_iii_is_a_factor():
    """Supplement, Calculation for model (i), case x1 < r < x2: printed 2 (x1/r - 1), 2 sqrt(1 - x1^2/r^2)."""
    r, x1, x2 = 1.2, 0.9, 1.7
    n = 400_000
    phi = (np.arange(n) + 0.5) * 2 * pi / n
    x, y = r * np.cos(phi), -r * np.sin(phi)
    g = np.where((x > x1) & (x < x2) & (y > 0), 1.0, 0.0) - np.where((x < -x1) & (x > -x2) & (y < 0), 1.0, 0.0)
    assert np.mean(g * np.sin(phi)) == pytest.approx((x1 / r - 1) / pi, abs=1e-5)
    assert np.mean(g * np.cos(phi)) == pytest.approx(sqrt(1 - x1**2 / r**2) / pi, abs=1e-5)


def test_the_linearised_rest_state_has_2_eps_mu_where_eps_squared_mu_is_printed():
    pair = contin.load("metronomes/pair")
    eps, mu, beta, h = 0.05, 3.0, 0.6, 1e-6
    values = pair.default_parameters({"eps": eps, "mu": mu, "beta": beta})

    def acceleration(common, rate):  # of z = x1 + x2 near rest
        state = {"x1": common / 2, "x2": common / 2, "y1": rate / 2, "y2": rate / 2}
        f = evaluate_all(pair.equations, {**values, **state})
        return f[1] + f[3]

    assert acceleration(h, 0) / h == pytest.approx(-(1 + 2 * eps * mu), rel=1e-9)
    damping = -acceleration(0, h) / h
    assert damping == pytest.approx(eps * beta * (1 + 2 * eps * mu), rel=1e-9)
    assert abs(damping - eps * beta * (1 + eps**2 * mu)) > 0.2 * eps * beta
