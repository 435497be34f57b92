"""Bogdanov-Takens points: normal forms hidden by changes of coordinates and units, and a closed form."""

import numpy as np
import pytest

from contin.normalforms.bogdanov_takens import bogdanov_takens

from .formulas import taylor_jet
from .polynomials import PolynomialJet, hide
from .test_static import signed

UNITS = [None, [1e4, 1.0, 1e-4], [1e-3, 1e3, 1.0]]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(4))
def test_a_and_b_survive_a_change_of_coordinates_and_units(seed, units):
    # u = T (w0, w1, ...): v = |T e0| w has a/|T e0| and b/|T e0|; q1's part along q0 changes neither
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=2)
    jet, T = hide([{(0, 1): 1.0}, {(2, 0): a, (1, 1): b}], [-1.0], rng, 2, units=units)
    form = bogdanov_takens(jet)
    assert form.coefficients["a"] == pytest.approx(a / signed(T[:, 0]), rel=1e-6)
    assert form.coefficients["b"] == pytest.approx(b / signed(T[:, 0]), rel=1e-5)
    assert form.coefficients["s"] == np.sign(a * b)


def test_jordan_chain_has_the_stated_normalisation():
    jet, _ = hide([{(0, 1): 1.0}, {(2, 0): 1.0, (1, 1): 1.0}], [-1.0, 0.4], np.random.default_rng(7), 2)
    v = bogdanov_takens(jet).vectors
    A, q0, q1, p0, p1 = jet.A, v["q0"], v["q1"], v["p0"], v["p1"]
    for got, expected in ((A @ q0, 0 * q0), (A @ q1, q0), (A.T @ p1, 0 * p1), (A.T @ p0, p1)):
        np.testing.assert_allclose(got, expected, atol=1e-12)
    products = [q0 @ q0, q0 @ q1, p0 @ q0, p1 @ q1, p0 @ q1, p1 @ q0]
    np.testing.assert_allclose(products, [1, 0, 1, 1, 0, 0], atol=1e-12)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(3))
def test_reflection_symmetry_is_recognised_and_its_cubic_coefficients_survive(seed, units):
    # an odd normal form, an odd change of coordinates of the critical variables and even stable directions
    rng = np.random.default_rng(seed)
    a3, b3 = rng.normal(size=2)
    odd = [{(0, 1): 1.0}, {(3, 0): a3, (2, 1): b3}]
    jet, T = hide(odd, [-1.0], rng, 3, units=units)
    form = bogdanov_takens(jet).coefficients
    assert form["kind"] == "Z2-symmetric"
    assert form["a3"] == pytest.approx(a3 / signed(T[:, 0]) ** 2, rel=1e-5)
    assert form["b3"] == pytest.approx(b3 / signed(T[:, 0]) ** 2, rel=1e-4)


def test_takens_bogdanov_point_of_the_symmetric_duffing_van_der_pol_oscillator():
    # x'' = -x^3 - x^2 x': a3 = b3 = -1
    form = bogdanov_takens(PolynomialJet([{(0, 1): 1.0}, {(3, 0): -1.0, (2, 1): -1.0}])).coefficients
    assert (form["a3"], form["b3"]) == (-1.0, -1.0)


def test_only_one_vanishing_coefficient_is_degenerate():
    form = bogdanov_takens(PolynomialJet([{(0, 1): 1.0}, {(2, 0): 1.0}])).coefficients
    assert form["kind"] == "degenerate"


def test_exothermic_reaction_at_its_bogdanov_takens_point():
    # u1' = -u1 + p1 (1 - u1) e^u2, u2' = -u2 + p1 p2 (1 - u1) e^u2 - p3 u2 with p2 = 18. Trace, determinant and F
    # vanish where u1 = z, p1 e^u2 (1 - z) = z, u2 = p2 z/(1 + p3); planar formulas (Kuznetsov, Elements, 3rd ed., 8.52)
    at = {"p1": 0.09615896637, "p3": 2.606872109}
    z, y = exothermic(at["p1"], at["p3"])
    formulas = ["-u1 + p1*(1 - u1)*exp(u2)", "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"]
    jet = taylor_jet(["u1", "u2"], ["p1", "p3"], formulas, {"u1": z, "u2": y, **at}, p2=18)
    assert np.abs(np.linalg.eigvals(jet.A)).max() < 1e-4  # a double zero to the digits of the parameters
    form = bogdanov_takens(jet)
    # independent: in the variables (v0, v1 = A v0-row) the planar field is v0' = v1 + ..., read off by hand
    q0, q1 = form.vectors["q0"], form.vectors["q1"]
    P = np.linalg.inv(np.column_stack([q0, q1]))

    def second(i, v, w, h=1e-4):
        def f(s, t):
            u = np.array([z, y]) + s * v + t * w
            g = at["p1"] * (1 - u[0]) * np.exp(u[1])
            return P[i] @ np.array([-u[0] + g, -u[1] + 18 * g - at["p3"] * u[1]])

        return (f(h, h) - f(h, -h) - f(-h, h) + f(-h, -h)) / (4 * h * h)

    assert form.coefficients["a"] == pytest.approx(second(1, q0, q0) / 2, rel=1e-5)
    assert form.coefficients["b"] == pytest.approx(second(0, q0, q0) + second(1, q0, q1), rel=1e-5)


def exothermic(p1, p3):
    """The double-zero equilibrium: u2 = 18 u1/(1 + p3), u1 where the trace vanishes."""
    from scipy.optimize import brentq

    def trace(z):
        g = z / (1 - z)  # p1 e^u2
        return -1 - g + 18 * z - 1 - p3

    z = brentq(trace, 1e-6, 0.5)
    return z, 18 * z / (1 + p3)
