"""The unfolding of a Bogdanov-Takens point and the homoclinic orbit that leaves it."""

import numpy as np
import pytest

from contin.normalforms.homoclinic import bogdanov_takens_unfolding
from contin.normalforms.homoclinic_series import homoclinic_series

from .polynomials import PolynomialJet, hide
from .test_static import residual, signed

# the homoclinic curve of b1 + b2 w1 + a w0^2 + b w0 w1: Melnikov, the ratio of two integrals of sech
CENTRE = [{(0, 1, 0, 0): 1.0}, {(0, 0, 1, 0): 1.0, (0, 1, 0, 1): 1.0, (2, 0, 0, 0): 0.9, (1, 1, 0, 0): -0.7}]


def test_normal_form_is_its_own_unfolding():
    unfolding = bogdanov_takens_unfolding(PolynomialJet(CENTRE, 2))
    np.testing.assert_allclose(unfolding.K, np.eye(2), atol=1e-14)
    np.testing.assert_allclose(unfolding.H, 0.0, atol=1e-14)
    assert (unfolding.a, unfolding.b) == pytest.approx((0.9, -0.7))


@pytest.mark.parametrize("seed", range(3))
def test_parameter_map_survives_a_change_of_coordinates(seed):
    jet, T = hide(CENTRE, [-1.0], np.random.default_rng(seed), 3, parameters=2)
    unfolding = bogdanov_takens_unfolding(jet)
    length = signed(T[:, 0])
    # b1 scales with w, b2 = dp2 + O(b1); the change of coordinates leaves the parameters alone
    np.testing.assert_allclose(unfolding.K[:, 1], [0.0, 1.0], atol=1e-7)
    assert unfolding.K[0, 0] == pytest.approx(1 / length, rel=1e-6)


@pytest.mark.parametrize("seed", range(2))
def test_homoclinic_predictor_satisfies_the_equations_to_order_four(seed):
    # u' - F along the predicted orbit: terms up to eps^3 cancel (velocity is of order eps^3)
    jet, _ = hide(CENTRE, [-1.0], np.random.default_rng(seed), 3, parameters=2)
    unfolding = bogdanov_takens_unfolding(jet)
    sizes, misses = 0.05 / 2.0 ** np.arange(4), []
    for eps in sizes:
        times = np.linspace(-4, 4, 41) / eps
        h = 1e-3 / eps
        speed = (unfolding.orbit(eps, times + h) - unfolding.orbit(eps, times - h)) / (2 * h)
        p = unfolding.parameters(eps)
        F = np.array([residual(jet, np.append(u, p)) for u in unfolding.orbit(eps, times)])
        along = (speed - F) @ unfolding.chain.p0
        misses.append(np.abs(along).max())
    assert np.polyfit(np.log(sizes), np.log(misses), 1)[0] > 3.8


def test_saddle_is_the_limit_of_the_orbit():
    unfolding = bogdanov_takens_unfolding(PolynomialJet(CENTRE, 2))
    np.testing.assert_allclose(unfolding.orbit(0.1, np.array([400.0]))[0], unfolding.saddle(0.1), atol=1e-15)


def test_melnikov_constant_ten_sevenths_by_quadrature():
    s = np.linspace(-20, 20, 40001)
    xi, eta = 2 - 6 / np.cosh(s) ** 2, 12 / np.cosh(s) ** 2 * np.tanh(s)
    assert -np.sum(xi * eta**2) / np.sum(eta**2) == pytest.approx(10 / 7, rel=1e-10)
    np.testing.assert_allclose(np.gradient(np.gradient(xi, s), s)[5:-5], (xi**2 - 4)[5:-5], atol=1e-4)


FULL = [
    {(0, 1, 0, 0): 1.0},
    {
        (0, 0, 1, 0): 1.0, (0, 1, 0, 1): 1.0, (2, 0, 0, 0): 0.9, (1, 1, 0, 0): -0.7, (3, 0, 0, 0): 0.5,
        (2, 1, 0, 0): 0.3, (1, 0, 0, 1): 0.4, (0, 2, 0, 0): 0.2, (1, 1, 0, 1): -0.3,
    },
]  # fmt: skip


@pytest.mark.parametrize("order", [3, 5])
def test_the_series_satisfies_the_equations_to_the_order_after_the_last_one_kept(order):
    jet, _ = hide(FULL, [-1.0], np.random.default_rng(0), 3, parameters=2)
    unfolding = bogdanov_takens_unfolding(jet)
    series = homoclinic_series(jet, unfolding)
    sizes, misses = 0.1 / 2.0 ** np.arange(4), []
    for eps in sizes:
        xi = np.linspace(-3, 3, 61)
        t, powers = np.tanh(xi), eps ** np.arange(order + 1.0)
        by_t = np.einsum("k,kjn->jn", powers, series.orbits[: order + 1])
        slope = (t[:, None] ** np.arange(len(by_t) - 1)) @ (np.arange(1, len(by_t))[:, None] * by_t[1:])
        clock = (t[:, None] ** np.arange(series.clock.shape[1])) @ (powers[: order - 1] @ series.clock[: order - 1])
        u = (t[:, None] ** np.arange(len(by_t))) @ by_t
        F = np.array([residual(jet, np.append(x, series.at(eps, order))) for x in u])
        misses.append(np.abs(((eps * clock * (1 - t**2))[:, None] * slope - F) @ unfolding.chain.p0).max())
    assert np.polyfit(np.log(sizes), np.log(misses), 1)[0] > order + 0.8


def test_the_series_starts_as_the_normal_form_says():
    """omega = 1 + (6/7) (-b/a) eps T + ..., p = (-4 eps^4/a, (10/7)(b/a) eps^2) (Al-Hdaibat et al. 2016)."""
    jet = PolynomialJet(CENTRE, 2)
    series = homoclinic_series(jet, bogdanov_takens_unfolding(jet))
    assert series.clock[1, 1] == pytest.approx(6 * 0.7 / (7 * 0.9), rel=1e-9)
    assert series.parameters[4, 0] == pytest.approx(-4 / 0.9, rel=1e-9)
    assert series.parameters[2, 1] == pytest.approx(-10 * 0.7 / (7 * 0.9), rel=1e-9)
