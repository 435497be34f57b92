"""D^2F[v, .] as Newton's method on curves of special points needs it: two Jacobians, not six."""

import numpy as np
import pytest

import contin


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e8])
def test_two_jacobians_give_the_gradient_to_what_newton_needs(scale):
    """F = a sin(b u) + p u, states of any size; `real` hides that the function takes complex numbers."""
    n, calls = 24, []
    a, b = np.random.default_rng(4).normal(size=(2, n, n)) / n

    def residual(u, p):
        x = np.asarray(u, dtype=float) / scale
        return scale * (a @ np.sin(b @ x) + p["p"] * x)

    def jacobian(u, p):
        calls.append(1)
        x = np.asarray(u, dtype=float) / scale
        return a * np.cos(b @ x) @ b + p["p"] * np.eye(n)

    u = scale * np.random.default_rng(6).uniform(1.0, 2.0, n)
    system = contin.FunctionProblem(residual, u, {"p": 0.3}, jacobian).system()
    v = np.append(scale * np.random.default_rng(7).normal(size=n), 0.2)
    system.gradient(u, [0.3], v, True)  # asks at first what the function takes
    calls.clear()
    rough = system.gradient(u, [0.3], v, True)
    assert len(calls) == 2
    exact = -(a * (np.sin(b @ u / scale) * (b @ v[:n] / scale))) @ b + 0.2 * np.eye(n)
    np.testing.assert_allclose(rough[:, :n], exact, atol=1e-7 * np.abs(exact).max())
    precise = system.gradient(u, [0.3], v)
    assert np.abs(precise[:, :n] - exact).max() < 1e-9 * np.abs(exact).max()
