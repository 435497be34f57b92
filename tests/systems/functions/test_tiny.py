"""States that are zero but for rounding, beside others near one: their steps are not those of 1e-16."""

import numpy as np
import pytest

import contin


@pytest.mark.parametrize("analytic", [True, False])
@pytest.mark.parametrize("tiny", [1e-9, 1e-12, -1e-16])
def test_derivatives_beside_a_zero_that_is_rounding(tiny, analytic):
    """dF_1/dy was 5 % off at 1e-12, by 1,000 at 1e-16 (differences), D^3F by 1e24 (circles: 1e22), without a word."""

    def residual(u, p):
        x, y = u if analytic else np.real(u).astype(float)
        return np.array([p["a"] + x * x + 0.3 * y * x + y**3 + x**3, -y * (1 + x) + 0.2 * x * y * y])

    u, p = np.array([0.5, tiny]), np.array([-1.0])
    system = contin.FunctionProblem(residual, u, {"a": -1.0}).system()
    exact = [[1.75 + 0.3 * tiny, 0.15 + 3 * tiny**2], [-tiny, -1.5 + 0.2 * tiny]]
    np.testing.assert_allclose(system.state_jacobian(u, p), exact, atol=2e-9)
    v = np.array([0.3, 0.4, 0.0])
    second = [5 * v[0] ** 2 + 0.6 * v[0] * v[1], -2 * v[0] * v[1] + 0.2 * v[1] ** 2]
    third = [6 * v[0] ** 3 + 6 * v[1] ** 3, 1.2 * v[0] * v[1] ** 2]
    np.testing.assert_allclose(system.derivative(u, p, v, v), second, atol=1e-8)
    np.testing.assert_allclose(system.derivative(u, p, v, v, v), third, atol=1e-7)


@pytest.mark.parametrize("analytic", [True, False])
def test_a_state_of_small_units_keeps_steps_of_its_own_size(analytic):
    """A Hill function with K = 1e-6 beside a state of 60: wide steps see none of its bend, and are not taken."""
    K, calls = 1e-6, []

    def residual(u, p):
        calls.append(1)
        v, c = u if analytic else np.real(u).astype(float)
        return np.array([-v * p["g"], c**4 / (K**4 + c**4)])

    u, p = np.array([-60.0, 1.3e-6]), np.array([1.0])
    system = contin.FunctionProblem(residual, u, {"g": 1.0}).system()
    x = 1.3
    slope = 4 * x**3 / (1 + x**4) ** 2
    bend = (12 * x**2 - 20 * x**6) / (1 + x**4) ** 3
    np.testing.assert_allclose(system.state_jacobian(u, p)[1, 1] * K, slope, rtol=1e-8)
    along = np.array([0.0, 1.0, 0.0])
    calls.clear()
    np.testing.assert_allclose(system.derivative(u, p, along, along)[1] * K * K, bend, rtol=1e-7)
    assert len(calls) <= 60


def test_third_derivatives_by_differences_where_many_states_are_rounding():
    """Weights that add up to 4e-15 of their size, and not to 0, hid that wider steps converge: errors were 4e35."""
    n = 20
    u, p = np.where(np.arange(n) % 2, 1e-16, 0.1), np.array([0.3])
    d = np.append(np.random.default_rng(0).normal(size=n), 0.0)
    problem = contin.FunctionProblem(lambda u, p: p["a"] * np.exp(u.astype(np.float64)) - 0.1 * u**3, u, {"a": 0.3})
    third = problem.system().derivative(u, p, d, d, d)
    np.testing.assert_allclose(third, (0.3 * np.exp(u) - 0.6) * d[:n] ** 3, atol=2e-6 * np.abs(third).max())
