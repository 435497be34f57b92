"""Formulas in arrays against formulas in numbers, node by node; complex steps against symbolic derivatives."""

import numpy as np
import pytest

from contin.model.evaluate import evaluate
from contin.model.parser import parse
from contin.pde.arrays import ArrayFormulas
from contin.symbolic.calculus.derivatives import derivative

FORMULAS = [
    "x^3 - 2/y + 1/3", "x^-2*y^0.5", "2^x + y^x", "x if x > y and y > 0.5 or not x < 1 else -y", "pi*x", "min(x, y, 1)",
    "max(x, y)", "mod(x, y) + floor(3*x) - ceil(y)", "atan2(x, -y)", "heaviside(x - 1) + sign(y - 1) + abs(x - y)",
    "log(x) + log1p(y) + log10(x)", "exp(x) + expm1(-y)", "sin(x)*cos(y)*tan(x)", "sinh(x) + cosh(y) + tanh(x)",
    "asin(x/9) + acos(y/9) + atan(x)", "asinh(x) + acosh(1 + y) + atanh(x/9)", "sqrt(x*y)", "factorial(3)*x", "5",
]  # fmt: skip
X, Y = np.array([0.3, 1.0, 2.5, 0.7]), np.array([0.9, 1.0, 0.4, 0.2])


@pytest.mark.parametrize("text", FORMULAS)
def test_arrays_give_what_numbers_give(text):
    formula = parse(text, ["x", "y"])
    found = ArrayFormulas([formula])({"x": X, "y": Y}, 4)[0]
    exact = [evaluate(formula, {"x": float(x), "y": float(y)}) for x, y in zip(X, Y, strict=True)]
    np.testing.assert_allclose(found, exact, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("text", FORMULAS[:3] + FORMULAS[10:17])
def test_complex_steps_give_derivatives(text):
    formula = parse(text, ["x", "y"])
    found = ArrayFormulas([formula])({"x": X + 1e-30j, "y": Y + 0j}, 4)[0].imag / 1e-30
    np.testing.assert_allclose(found, ArrayFormulas([derivative(formula, "x")])({"x": X, "y": Y}, 4)[0], rtol=1e-12)
