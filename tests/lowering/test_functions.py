"""Value and derivatives 1 to 3 of every function of the grammar, from machine code, against mpmath in 60 digits."""

import mpmath
import numpy as np
import pytest

from contin.lowering import CompiledSystem
from contin.model.evaluate import evaluate
from contin.model.expression import symbol
from contin.model.parser import parse
from contin.model.vocabulary import FUNCTIONS

from .systems import compiled, equations

SMOOTH = {  # formula in x: arguments, among them the delicate ones
    "sin(x)": [0.0, 1e-9, 0.5, np.pi, -1.5707963, 20.0],
    "cos(x)": [0.0, 1e-9, 0.5, np.pi, -1.5707963, 20.0],
    "tan(x)": [0.0, 1e-9, 0.5, 1.5, -1.5, 3.0],
    "asin(x)": [0.0, 1e-9, 0.5, -0.999, 0.999999],
    "acos(x)": [0.0, 1e-9, 0.5, -0.999, 0.999999],
    "atan(x)": [0.0, 1e-9, 1.0, -3.0, 1e3],
    "sinh(x)": [0.0, 1e-9, 1.0, -3.0, 30.0],
    "cosh(x)": [0.0, 1e-9, 1.0, -3.0, 30.0],
    "tanh(x)": [0.0, 1e-9, 1.0, -3.0, 30.0, 800.0, -1e6],
    "asinh(x)": [0.0, 1e-9, 1.0, -3.0, 1e12],
    "acosh(x)": [1.0 + 1e-3, 2.0, 1e12],
    "atanh(x)": [0.0, 1e-9, 0.5, -0.999],
    "floor(x)": [0.3, -2.5, 1e9 + 0.5],
    "ceil(x)": [0.3, -2.5, 1e9 + 0.5],
    "mod(x, 3)": [4.2, -1.3, 1e6 + 0.5],
    "mod(7, x)": [2.3, -4.1],
    "factorial(floor(x))": [0.5, 5.5, 30.5, 170.5],
    "exp(x)": [0.0, 1e-9, 1.0, -700.0, 30.0],
    "expm1(x)": [0.0, 1e-9, 1e-15, 1.0, -40.0],
    "log(x)": [1.0, 1.0 + 1e-9, 1e-9, 1e9, 1e-60],
    "log1p(x)": [0.0, 1e-9, 1e-15, -0.999, 1e9],
    "log10(x)": [1.0, 10.0, 1e-9, 1e9],
    "sqrt(x)": [1.0, 1e-9, 4.0, 1e9],
    "abs(x)": [1e-9, -1e-9, 3.0, -3.0],
    "sign(x)": [1e-9, -3.0],
    "heaviside(x)": [1e-9, -3.0],
    "atan2(x, 2)": [0.0, 1e-9, 1.0, -5.0],
    "atan2(1, x)": [0.0, 1e-9, 1.0, -5.0],
    "atan2(-x, x^2 - 3)": [1e-9, 1.0, -5.0],
    "min(x, x^3)": [0.5, 2.0, -0.5, -2.0],
    "max(x, x^3)": [0.5, 2.0, -0.5, -2.0],
    "min(x, 2, x^2)": [0.5, 1.2, 3.0],
    "x^7": [0.0, 1e-9, -1.5],
    "x^(-3)": [1e-3, -1.5],
    "x^2.5": [1e-9, 1.5],
    "x^(-0.5)": [1e-3, 1.5],
    "x^(1/3)": [1e-3, 8.0],
    "2^x": [0.0, -1.0, 3.5],
    "x^x": [0.5, 1.0, 2.0],
    "abs(x)^3": [1e-9, -0.7, 2.0],
    "exp(-x^2)*sin(3*x)/(1 + x^2)": [0.0, 0.3, -2.0],
    "x^2 if x < 1 else 2*x - 1": [0.5, 1.5],
    "1/x if x > 0 and not x > 2 else log(3 - x)": [0.5, -1.0, 2.5],
}


def reference(text: str, x: float, order: int) -> mpmath.mpf:
    formula = parse(text, {"x": symbol("x")})
    with mpmath.workdps(400):
        if order == 0:
            return evaluate(formula, {"x": mpmath.mpf(x)}, mpmath)
        step = mpmath.mpf(10) ** -100
        return mpmath.diff(lambda z: evaluate(formula, {"x": z}, mpmath), mpmath.mpf(x), order, h=step)


def test_every_function_of_the_grammar_is_in_the_table():
    assert {name for name in FUNCTIONS if any(name + "(" in text for text in SMOOTH)} == FUNCTIONS


@pytest.mark.parametrize("text", SMOOTH)
def test_derivatives_zero_to_three_agree_with_mpmath(text):
    system = CompiledSystem(equations({"x": text}))  # floor and its like, too, which branches of flows refuse
    one = np.ones(1)
    for x in SMOOTH[text]:
        want = [reference(text, x, order) for order in range(4)]
        got = [system.derivative([x], [], *[one] * order)[0] for order in range(4)]
        natural = min(1.0, max(abs(float(w)) for w in want))  # bounded functions: errors count against their size
        for order in range(4):
            assert got[order] == pytest.approx(float(want[order]), rel=2e-12, abs=1e-13 * natural), (x, order)
        assert system.jacobian([x], [])[1][0, 0] == pytest.approx(got[1], rel=1e-14)


@pytest.mark.parametrize(
    ("text", "x", "want"),
    [
        ("abs(x)", 0.0, [0.0, 0.0, 0.0, 0.0]),  # the mean of both slopes
        ("sign(x)", 0.0, [0.0, 0.0, 0.0, 0.0]),
        ("heaviside(x)", 0.0, [0.5, 0.0, 0.0, 0.0]),  # no delta functions
        ("x*abs(x)", 0.0, [0.0, 0.0, 0.0, 0.0]),
        ("abs(x)^3", 0.0, [0.0, 0.0, 0.0, 0.0]),
        ("min(x, 2*x)", 0.0, [0.0, 1.0, 0.0, 0.0]),  # a tie takes the first argument's slope
        ("max(x, 2*x)", 0.0, [0.0, 1.0, 0.0, 0.0]),
        ("x^2 if x <= 1 else 5*x", 1.0, [1.0, 2.0, 2.0, 0.0]),  # the branch that is taken
        ("x^2 if x < 1 else 5*x", 1.0, [5.0, 5.0, 0.0, 0.0]),
    ],
)
def test_conventions_at_kinks_and_jumps(text, x, want):
    system = compiled({"x": text})
    got = [system.derivative([x], [], *[np.ones(1)] * order)[0] for order in range(4)]
    assert got == want


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0, 4.0])
def test_power_with_symbolic_exponent_has_finite_derivatives_at_zero(exponent):
    """x^n with a parameter n at x = 0: the k-th derivative is n! where k = n and 0 otherwise, as far as it exists."""
    system = compiled({"x": "x^n"}, ["n"])
    along_x = np.array([1.0, 0.0])
    for order in range(1, 4):
        want = float(mpmath.factorial(exponent)) if order == exponent else 0.0
        if order <= exponent:
            assert system.derivative([0.0], [exponent], *[along_x] * order)[0] == want
    assert system.derivative([0.0], [exponent], np.array([0.0, 1.0]))[0] == 0.0  # d/dn 0^n


def test_derivative_with_respect_to_the_exponent():
    system = compiled({"x": "x^n"}, ["n"])
    x, n = 1.7, 2.3
    _, matrix = system.jacobian([x], [n])
    np.testing.assert_allclose(matrix, [[n * x ** (n - 1), x**n * np.log(x)]], rtol=1e-15)
    mixed = system.derivative([x], [n], np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    assert mixed[0] == pytest.approx(x ** (n - 1) * (1 + n * np.log(x)), rel=1e-14)


def test_mixed_derivative_at_an_exponent_that_annuls_the_second_derivative():
    """d/dn d^2/dx^2 x^n = (2 n - 1) x^(n - 2) + n (n - 1) x^(n - 2) log x, at n = 1."""
    system = compiled({"x": "x^n"}, ["n"])
    along_x, along_n = np.eye(2)
    assert system.derivative([1.7], [1.0], along_x, along_x, along_n)[0] == pytest.approx(1 / 1.7, rel=1e-15)
