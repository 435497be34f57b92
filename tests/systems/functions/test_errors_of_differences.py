"""Coefficients of functions that are given by values alone: differences resolve them, and their errors say how well.

x' = mu x - y - tanh(k x)^3/k + 0.3 tanh(k y)^2, y' = x + mu y has a Hopf point at mu = 0, omega = 1. With the Taylor
series -k^2 x^3 and 0.3 k^2 y^2 there, Kuznetsov's formula (Elements, 3rd ed., (3.20), with the quadratic term of one
variable in one equation alone, whose products vanish) gives l1 = 6 (-k^2)/16 times 2 in contin's scale: -0.75 k^2.
"""

import math

import numpy as np
import pytest

from contin import FunctionProblem, continuation, equilibrium


def with_cast(cast, k):
    def value(u, p):
        x, y = cast(u[0]), cast(u[1])
        tanh = math.tanh if cast is float else np.tanh
        return np.array([p["mu"] * x - y - tanh(k * x) ** 3 / k + 0.3 * tanh(k * y) ** 2, x + p["mu"] * y])

    return FunctionProblem(value, [0.0, 0.0], {"mu": -0.5}, states=("x", "y"))


@pytest.mark.parametrize("cast", [float, lambda x: x], ids=["stencils", "circles"])
@pytest.mark.parametrize("k", [1.0, 5.0, 20.0, 60.0, 200.0])
def test_the_lyapunov_coefficient_is_right_to_its_error_whatever_the_length_of_the_function(k, cast):
    (hopf,) = continuation(equilibrium(with_cast(cast, k)), "mu", (-1, 1)).points
    form = hopf.normal_form
    assert (hopf.type, form["criticality"]) == ("HB", "supercritical")
    assert abs(form["l1"] + 0.75 * k * k) <= form["errors"]["l1"] <= 1e-5 * k * k


@pytest.mark.parametrize("form", ["stencils", "circles", "jacobian"])
def test_what_vanishes_is_zero_to_its_error(form):
    """The logistic map x -> r x (1 - x): its third derivative is zero, so b30 of the branch point is."""

    def value(u, p):
        x = float(u[0]) if form == "stencils" else u[0]
        return np.array([p["r"] * x * (1.0 - x)])

    given = {"jacobian": lambda u, p: np.array([[p["r"] * (1.0 - 2.0 * u[0])]])} if form == "jacobian" else {}
    problem = FunctionProblem(value, [0.0], {"r": 0.5}, kind="map", **given)
    (point,) = [p for p in continuation(equilibrium(problem), "r", (0.2, 1.5)).points if p.type == "BP"]
    exact = {"b11": 1.0, "b20": -2.0, "b30": 0.0}
    for name, expected in exact.items():
        assert abs(point.normal_form[name] - expected) <= point.normal_form["errors"][name], name
