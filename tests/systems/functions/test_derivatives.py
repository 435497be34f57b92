"""Derivatives of user functions: complex circles lose almost nothing, stencils have their order."""

import math

import numpy as np
import pytest

from contin.systems.functions.derivatives import Lines, is_analytic
from contin.systems.functions.stencils import HALF_WIDTHS, STEPS, stencil

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


@pytest.mark.parametrize(
    ("counts", "lines"), [((1, 1), 2), ((2, 1), 3), ((3, 1), 4), ((2, 2), 4), ((2, 1, 1), 6), ((3, 2), 6), ((4, 1), 5)]
)
def test_equal_directions_share_their_lines(counts, lines):
    """D^k exp(w z)[d1, ..., dk] = exp(w z) times the product of w d; each line is asked on one circle of 9 points."""
    asked = []

    def wave(u, p):
        asked.append(u)
        return np.exp(0.3 * u[:1] - 0.5 * u[1:] + 0.2 * p)

    u, directions = np.array([0.4, -1.3]), np.random.default_rng(5).normal(size=(len(counts), 3))
    wanted = [d for d, count in zip(directions, counts, strict=True) for _ in range(count)]
    value = Lines(lambda u, p: np.append(wave(u, p), 0.0), SIZES, True).form(u, P, wanted)[0]
    along = np.prod([np.dot([0.3, -0.5, 0.2], d) for d in wanted])
    order = len(wanted)
    rounding = 1e-14 * math.factorial(order) / 0.1**order  # of circles of radius 0.1
    assert value == pytest.approx(wave(u, P)[0] * along, rel=1e-9, abs=rounding)
    assert len(asked) - 1 == 9 * lines


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


@pytest.mark.parametrize("analytic", [True, False])
@pytest.mark.parametrize("k", [1.0, 5.0, 40.0, 300.0])
def test_differences_are_as_narrow_as_the_function_bends(k, analytic):
    """tanh(k x) and its square beside a component with the length 1: poles at i pi/(2 k), each with its own steps."""

    def value(u, p):
        return np.array([np.tanh(k * u[0]), np.tanh(k * u[0]) ** 2, np.exp(u[0])])

    lines = Lines(value, np.ones(2), analytic)
    u, p, v = np.zeros(1), np.ones(1), np.array([1.0, 0.0])
    sizes = np.array([k**3, k**2, 1.0])
    exact = {2: np.array([0.0, 2.0 * k**2, 1.0]), 3: np.array([-2.0 * k**3, 0.0, 1.0])}
    for order, expected in exact.items():
        error = np.abs(lines.pure(u, p, v, order) - expected)
        assert np.all(error <= 1e-7 * np.array([k**order, k**order, 1.0])), (order, error / sizes)
    assert lines.first(u, p, v)[:2] == pytest.approx([k, 0.0], rel=1e-10, abs=1e-10 * k)


def test_narrower_differences_stay_where_the_function_is_defined():
    """sqrt(x - 0.999) at x = 1: the usual steps, of the size 1, leave its domain."""
    lines = Lines(lambda u, p: np.sqrt(u - 0.999), np.ones(2), False)
    u, p, v = np.ones(1), np.ones(1), np.array([1.0, 0.0])
    with np.errstate(invalid="ignore"):
        assert lines.pure(u, p, v, 1)[0] == pytest.approx(0.5 * 1e-3**-0.5, rel=1e-9)
        assert lines.pure(u, p, v, 2)[0] == pytest.approx(-0.25 * 1e-3**-1.5, rel=1e-6)


def test_smooth_functions_take_one_set_of_differences():
    count = 0

    def counted(u, p):
        nonlocal count
        count += 1
        return smooth(u, p)

    for order in (1, 2, 3):
        count = 0
        Lines(counted, SIZES, False).pure(np.array([0.4, -1.3]), P, np.array([0.5, -0.8, 0.3]), order)
        assert count <= 2 * HALF_WIDTHS[order] + 1


def test_rounding_of_terms_that_cancel_asks_for_no_smaller_circles():
    """exp(x) and what rounding leaves of (x + 1e6) - 1e6 - x, 1e-10: least on the first circle."""
    count = 0

    def counted(u, p):
        nonlocal count
        count += 1
        return (u + 1e6) - 1e6 - u + np.exp(u)

    lines = Lines(counted, np.ones(2), True)
    found = lines.pure(np.array([0.3]), np.ones(1), np.array([1.0, 0.0]), 2)
    assert found[0] == pytest.approx(np.exp(0.3), rel=1e-7)
    assert count == 9


@pytest.mark.parametrize("unit", [1e-30, 1.0, 1e30])
def test_a_constraint_along_directions_that_keep_it_takes_no_circle_more(unit):
    """Its values are rounding, which no smaller circle makes less: six circles were tried, of nine values each."""
    g, calls = np.array([0.3, -1.7, 0.9, 2.1]), []

    def function(u, p):
        calls.append(1)
        return np.array([np.exp(u[0]) * u[1], unit * (g @ u), 1.0 / (u[2] - p[0]), -u[3]])

    def kept(x):
        return x - g * (g @ x) / (g @ g)

    lines = Lines(function, np.ones(5), True)
    u, *directions = (kept(np.array(x)) for x in ([0.4, 1.0, 0.5, 0.0], [0.7, -0.2, 0.3, 0.5], [0.1, 0.6, -0.8, 0.2]))
    for p, most in ((np.array([9.0]), 10), (np.array([u[2] - 0.01]), 54)):  # a pole far away, and one on the circle
        for v in directions:  # the pole is a node of the second one's third circle
            calls.clear()
            with np.errstate(all="ignore"):
                found, far = lines.pure(u, p, np.append(v, 0.0), 2), u[2] - p[0]
            assert len(calls) <= most
            assert found[0] == pytest.approx(np.exp(u[0]) * (v[0] ** 2 * u[1] + 2.0 * v[0] * v[1]), rel=1e-9)
            assert abs(found[1]) < 1e-10 * unit
            assert found[2] == pytest.approx(2.0 * v[2] ** 2 / far**3, rel=1e-7)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("narrower", [0, 1])
def test_weights_of_a_stencil_add_up_to_nothing_but_rounding_and_have_its_symmetry(order, narrower):
    """A third derivative's inner weights added up to 4e-15 of their size, over h^3, and called the function at 0."""
    rule = dict(stencil(order, HALF_WIDTHS[order] - narrower))
    assert abs(sum(rule.values())) < 1e-16 * sum(map(abs, rule.values()))
    assert all(rule[-o] == (-1) ** order * weight for o, weight in rule.items())
    assert (0 in rule) == (order % 2 == 0)
