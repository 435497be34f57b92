"""The unfolding of a Bogdanov-Takens point and the homoclinic orbit that leaves it."""

import numpy as np
import pytest

from contin.normalforms.homoclinic import bogdanov_takens_unfolding

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
