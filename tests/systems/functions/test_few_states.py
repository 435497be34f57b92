"""Functions of few states: all columns of the Jacobian by complex steps at once, whatever form the user's one has."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator

import contin
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.functions.function_system import FunctionSystem

PARAMETERS = {"a": 0.2, "b": 0.3, "c": 2.0}
U, P = np.array([1.0, 0.3, -0.4]), np.array([0.2, 0.3, 2.0])


def roessler(u, p):
    return np.array([-u[1] - u[2], u[0] + p["a"] * u[1], p["b"] + u[2] * (u[0] - p["c"])])


def slopes(u, p):
    return np.array([[0, -1, -1], [1, p["a"], 0], [u[2], 0, u[0] - p["c"]]])


FULL = np.hstack([slopes(U, {"a": 0.2, "c": 2.0}), [[0, 0, 0], [U[1], 0, 0], [0, 1, -U[2]]]])


def counted(form):
    """The system, and how often its function and its Jacobian are asked."""
    calls = {"values": 0, "jacobians": 0}

    def residual(u, p):
        calls["values"] += 1
        return roessler(u, p)

    def jacobian(u, p):
        calls["jacobians"] += 1
        matrix = slopes(u, p)
        return LinearOperator((3, 3), matvec=lambda v: matrix @ v) if form == "products" else sp.csc_matrix(matrix)

    given = None if form == "values" else jacobian
    return FunctionSystem(FunctionProblem(residual, [0.1] * 3, PARAMETERS, given)), calls


@pytest.mark.parametrize("form", ["values", "sparse", "products"])
def test_a_full_jacobian_costs_a_value_a_column_and_is_exact(form):
    system, calls = counted(form)
    system.jacobian(U, P)  # what is asked once is asked now
    before = dict(calls)
    found = system.jacobian(U, P)[1]
    np.testing.assert_allclose(found, FULL, rtol=1e-15, atol=1e-15)
    assert calls["values"] - before["values"] == 7  # one for the value
    assert calls["jacobians"] == before["jacobians"]


@pytest.mark.parametrize("form", ["values", "sparse", "products"])
def test_second_derivatives_cost_six_jacobians(form):
    system, calls = counted(form)
    system.gradient(U, P, np.arange(6.0))
    before = calls["values"]
    found = system.gradient(U, P, np.arange(6.0))
    assert calls["values"] - before <= 36 + 5  # five where complex steps are looked at again
    expected = np.zeros((3, 6))
    expected[1, [1, 3]] = 3.0, 1.0  # a y
    expected[2, [0, 2, 2, 5]] = 2.0, 0.0, -5.0, -2.0  # z x - z c
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_function_that_fails_in_a_column_is_asked_again_and_named():
    def residual(u, p):
        if np.real(u[0]) > 2.0 and np.iscomplexobj(u):
            raise ValueError("no complex numbers here")
        return roessler(u, p)

    system = FunctionSystem(FunctionProblem(residual, [0.1] * 3, PARAMETERS))
    system.jacobian(U, P)
    far = np.array([3.0, 0.0, 0.0])
    assert np.isnan(system.jacobian(far, P)[1]).any()
    assert "no complex numbers here" in system.trouble_near(far, P)


def test_a_sparse_function_of_few_states_has_curves_of_doublings():
    """Of a Moebius band whose multiplier is -exp(2 pi (mu - nu^2)): doublings lie at mu = nu^2."""

    def band(u, p):
        x, y, a, b = u
        c, h, q = p["mu"] - p["nu"] ** 2, 1 - x * x - y * y, a * a + b * b
        along, across = (c - 1) / 2 * a + (c + 1) / 2 * (x * a + y * b), (c - 1) / 2 * b + (c + 1) / 2 * (y * a - x * b)
        return np.array([x * h - y, y * h + x, along - b / 2 - a * q, across + a / 2 - b * q])

    def jacobian(u, p):
        columns = [band(u + 1e-30j * e, p).imag / 1e-30 for e in np.eye(4)]
        return sp.csc_matrix(np.column_stack(columns))

    model = contin.FunctionProblem(band, [1.0, 0, 0, 0], {"mu": 0.2, "nu": 0.5}, jacobian)
    t = np.linspace(0.0, 2.0 * np.pi, 25)
    start = contin.periodic_orbit(model, np.column_stack([np.cos(t), np.sin(t), 0 * t, 0 * t]), times=t, intervals=6)
    settings = {"intervals": 6, "step": 0.3, "max_step": 0.5}
    doubling = contin.continuation(start, "mu", (0.2, 0.3), settings=settings | {"stop_at": ("PD",)})["PD1"]
    assert abs(doubling.values["mu"] - 0.25) <= doubling.error
    line = contin.continuation(
        doubling.locus(["mu", "nu"]), ["mu", "nu"], {"mu": (0.2, 0.3), "nu": (0.4, 0.6)}, settings={"steps": 1}
    )
    np.testing.assert_allclose(line.columns["mu"], line.columns["nu"] ** 2, atol=1e-9)
