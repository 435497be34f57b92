"""Slopes by parameters with real states: the same numbers, also of functions that fill arrays of the states' type."""

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.systems.functions.derivatives import Lines
from contin.systems.functions.function_system import FunctionSystem

N = 40
LAPLACE = sp.diags([np.ones(N - 1), -2.0 * np.ones(N), np.ones(N - 1)], [-1, 0, 1], format="csc")


def plain(u, p):
    return LAPLACE @ u + p["a"] * np.exp(u) + p["b"] ** 2 * u


def filling(u, p):
    """Every entry is written into an array of the states' type, which holds no imaginary part of a parameter."""
    found = np.empty_like(u)
    found[:] = plain(u, p)
    return found


def filling_somewhere(u, p):
    """The same where states are above 2, as none is at the start."""
    return filling(u, p) if u.real.max() > 2.0 else plain(u, p)


@pytest.mark.parametrize("function", [plain, filling, filling_somewhere])
def test_slopes_by_parameters_are_exact_however_the_function_is_written(function):
    complex_states = []

    def told(u, p):
        complex_states.append(np.iscomplexobj(u))
        return function(u, p)

    def jacobian(u, p):
        return (LAPLACE + sp.diags(p["a"] * np.exp(u) + p["b"] ** 2)).tocsc()

    problem = contin.FunctionProblem(told, np.zeros(N), {"a": 0.3, "b": 0.7}, jacobian)
    system = FunctionSystem(problem)
    p = np.array([0.3, 0.7])
    system.parameter_slope(np.zeros(N), p, 0)  # what the function takes is asked once
    for u in (np.linspace(-1.0, 1.0, N), np.linspace(0.0, 3.0, N)):
        for k, exact in enumerate((np.exp(u), 2.0 * p[1] * u)):
            complex_states.clear()
            np.testing.assert_allclose(system.parameter_slope(u, p, k), exact, rtol=1e-14, atol=1e-300)
            if function is plain:
                assert complex_states == [False]
        assert system.trouble_near(u, p) is None


def test_a_functional_of_a_second_derivative_takes_one_circle_and_gives_its_terms():
    """Of exp(u), beside what rounding leaves of (u + 1e6) - 1e6 and exp(2 u), whose own series takes more circles."""
    count = 0

    def counted(u, p):
        nonlocal count
        count += 1
        return np.array([np.exp(u[0]), np.exp(2.0 * u[0]) + ((u[0] + 1e6) - 1e6 - u[0]), 1.0 * u[0]])

    lines, u, v = Lines(counted, np.ones(2), True), np.array([0.3]), np.array([1.0, 0.0])
    value, terms = lines.functional_with_terms(lambda f: f[0] + f[2], u, np.ones(1), v, 2)
    assert count == 9
    np.testing.assert_allclose(terms, [np.exp(0.3), 4.0 * np.exp(0.6), 0.0], atol=1e-6)
    assert value == pytest.approx(np.exp(0.3), rel=1e-12)
