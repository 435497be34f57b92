"""Derivatives of user functions: complex circles lose almost nothing, stencils have their order."""

import numpy as np
import pytest

from contin.systems.functions.derivatives import HALF_WIDTHS, STEPS, Lines, is_analytic, stencil

P = np.array([0.7])
SIZES = np.ones(3)


def smooth(u, p):
    return np.array([np.exp(u[0]) * np.sin(p[0] * u[1]), u[0] ** 3 * u[1] + p[0] ** 2])


def exact_pure(u, v, order):
    """k-th derivative of `smooth` along v at (u, P), by mpmath."""
    import mpmath as mp

    mp.mp.dps = 40
    x, y, q = (mp.mpf(float(a)) for a in (*u, P[0]))
    a, b, c = (mp.mpf(float(w)) for w in v)
    first = mp.diff(lambda t: mp.e ** (x + t * a) * mp.sin((q + t * c) * (y + t * b)), 0, order)
    second = mp.diff(lambda t: (x + t * a) ** 3 * (y + t * b) + (q + t * c) ** 2, 0, order)
    return np.array([float(first), float(second)])


ERRORS = [(1, 1e-15, 1e-11), (2, 1e-12, 1e-9), (3, 1e-10, 1e-8)]


@pytest.mark.parametrize(("order", "analytic_error", "real_error"), ERRORS)
def test_pure_derivatives_against_mpmath(order, analytic_error, real_error):
    u, v = np.array([0.4, -1.3]), np.array([0.5, -0.8, 0.3])
    expected = exact_pure(u, v, order)
    for analytic, error in ((True, analytic_error), (False, real_error)):
        lines = Lines(smooth, SIZES, analytic)
        value = lines.first(u, P, v) if order == 1 else lines.pure(u, P, v, order)
        np.testing.assert_allclose(value, expected, rtol=error, atol=error)


def test_mixed_derivatives_by_polarisation():
    u = np.array([0.4, -1.3])
    cubic = Lines(lambda u, p: np.array([u[0] * u[1] * p[0], 0.0 * u[0]]), SIZES, True)
    e = np.eye(3)
    assert cubic.form(u, P, [e[0], e[1], e[2]])[0] == pytest.approx(1.0, abs=1e-11)  # d^3 (x y p)
    assert cubic.form(u, P, [e[0], e[2]])[0] == pytest.approx(u[1], abs=1e-12)
    assert cubic.form(u, P, [e[0], e[0]])[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_stencils_are_exact_on_polynomials_of_their_degree_and_have_their_order(order):
    half = HALF_WIDTHS[order]
    for degree in range(2 * half + 1):
        value = sum(w * float(o) ** degree for o, w in stencil(order))
        expected = float(np.prod(np.arange(1, order + 1))) if degree == order else 0.0
        assert value == pytest.approx(expected, abs=1e-9 * half**degree)
    h = np.array([0.8, 0.4])
    error = [abs(sum(w * np.exp(o * s) for o, w in stencil(order)) / s**order - 1.0) for s in h]
    claimed = 2 * ((2 * half + 2 - order) // 2)
    assert np.log2(error[0] / error[1]) == pytest.approx(claimed, abs=0.5)
    assert STEPS[order] < 0.1


def test_functions_that_are_not_analytic_are_recognised():
    u, p = np.array([0.4, -1.3]), P
    assert is_analytic(smooth, u, p, SIZES)
    assert not is_analytic(lambda u, p: np.abs(u) * p[0], u, p, SIZES)  # complex abs: no derivative
    assert not is_analytic(lambda u, p: np.array([float(x) for x in u.real]), u, p, SIZES)
    assert not is_analytic(lambda u, p: np.array([x.__float__() for x in u]), u, p, SIZES)  # raises for complex
    assert not is_analytic(lambda u, p: np.conj(u) * u, u, p, SIZES)
