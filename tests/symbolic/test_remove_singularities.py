"""Removable singularities: value and derivatives 1 to 3 against contour integrals of the quotient in 30 digits."""

import mpmath
import numpy as np
import pytest

from contin.model.evaluate import evaluate
from contin.model.expression import postorder, symbol
from contin.model.parser import parse
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.guards import is_guard
from contin.symbolic.calculus.remove_singularities import remove_singularities

SMALL = [1e-9, 1e-7, 1e-5, 1e-3, 1e-2, 1e-1]
EDGES = [0.249, 0.251, 0.374, 0.376, 0.499, 0.501, 0.7]  # both sides of every guard

CASES = {  # formula: (variable, its value at the singularity, other values)
    "0.1*(V + 40)/(1 - exp(-(V + 40)/10))": ("V", -40, {}),  # Hodgkin and Huxley 1952, alpha_m
    "(0.01*V + 0.55)/(1 - exp(-0.1*V - 5.5))": ("V", -55, {}),
    "a*(25 - V)/(exp((25 - V)/10) - 1)": ("V", 25, {"a": 0.3}),
    "(V - Vm)/(1 - exp(-(V - Vm)/k))": ("V", -37.5, {"Vm": -37.5, "k": 7.3}),
    "((V - Vm)/k)^2/(cosh((V - Vm)/k) - 1)": ("V", -37.5, {"Vm": -37.5, "k": 7.3}),
    "V*(a - b*exp(-V))/(1 - exp(-V))": ("V", 0, {"a": 2, "b": 0.7}),  # Goldman, Hodgkin, Katz flux
    "P*z^2*V*F^2/(R*T)*(c - C*exp(-z*V*F/(R*T)))/(1 - exp(-z*V*F/(R*T)))": (
        "V",
        0,
        {"P": 1.2, "z": 2, "F": 0.9, "R": 1.3, "T": 0.8, "c": 1, "C": 0.3},
    ),
    "V*exp(a*V)/(exp(a*V) - 1)": ("V", 0, {"a": 1.1}),
    "(u^2 + v^2)/(1 - exp(-(u^2 + v^2)/k))": ("u", 0, {"v": 0, "k": 0.7}),
    "sin(x*y)/(x*y)": ("x", 0, {"y": 0.5}),
    "x/expm1(a*x)": ("x", 0, {"a": 2.5}),
    "expm1(a*x)/x": ("x", 0, {"a": -2.5}),
    "x/(2^x - 1)": ("x", 0, {}),
    "x/sin(x)": ("x", 0, {}),
    "sin(3*x)/x": ("x", 0, {}),
    "tan(x)/x": ("x", 0, {}),
    "x/tan(x)": ("x", 0, {}),
    "sinh(x)/x": ("x", 0, {}),
    "tanh(a*x)/x": ("x", 0, {"a": -1.7}),
    "atan(x)/x": ("x", 0, {}),
    "asin(x)/x": ("x", 0, {}),
    "log1p(x)/x": ("x", 0, {}),
    "log(x)/(x - 1)": ("x", 1, {}),
    "(x - 1)/log(x)": ("x", 1, {}),
    "log(1 + r^2)/r": ("r", 0, {}),
    "log(1 + r^4)/r": ("r", 0, {}),  # averaged escapement
    "log(1 + a*r^4)/r^3": ("r", 0, {"a": 3.1}),
    "log(1 + r^8)/r": ("r", 0, {}),
    "(log(1 + r^2) - r^2)/r^3": ("r", 0, {}),
    "(1 - cos(x))/x": ("x", 0, {}),
    "(1 - cos(x))/x^2": ("x", 0, {}),
    "(exp(x) - 1 - x)/x^2": ("x", 0, {}),
    "((exp(x) - 1)/x - 1)/x": ("x", 0, {}),
    "(sqrt(1 + x) - 1)/x": ("x", 0, {}),
    "((1 + x)^2.5 - 1)/x": ("x", 0, {}),
    "y*x*cos(x)/(sin(x)*(1 + x))": ("x", 0, {"y": 1.3}),
    "x/sin(x) + (V + 40)/(1 - exp(-(V + 40)/10))": ("x", 0, {"V": -39.9}),
    "(exp(a*V) - exp(a*U))/(V - U)": ("V", 0.7, {"U": 0.7, "a": 1.3}),
    "cosh(x)/sinh(x) - 1/x": ("x", 0, {}),  # Langevin function: poles that cancel
    "1/(exp(x) - 1) - 1/x": ("x", 0, {}),
    "log(1 + (u^2 + v^2)^2)/(u^2 + v^2)": ("u", 0, {"v": 0}),
    "sin(sqrt(u^2 + v^2))/sqrt(u^2 + v^2)": ("u", 0, {"v": 1e-3}),
    "(x^3 + 2*x)/x": ("x", 0, {}),
    "(x^2 + a*x)/(x^3 + 2*x)": ("x", 0, {"a": 0.3}),
    "(x^2 - 1)/(x - 1)": ("x", 1, {}),
}


def formula_of(text):
    variable, _, others = CASES[text]
    return parse(text, {name: symbol(name) for name in [variable, *others]})


def complex_value(formula, env):
    """The formula for complex arguments."""
    values = {}
    for node in postorder([formula]):
        args = [values[a] for a in node.args]
        if node.op == "symbol":
            values[node] = env[node.value]
        elif node.op == "number":
            values[node] = mpmath.mpf(node.value.numerator) / node.value.denominator
        elif node.op in ("add", "mul"):
            values[node] = mpmath.fsum(args) if node.op == "add" else mpmath.fprod(args)
        elif node.op == "pow":
            values[node] = args[0] ** args[1]
        elif node.op in ("expm1", "log1p"):
            values[node] = mpmath.exp(args[0]) - 1 if node.op == "expm1" else mpmath.log(1 + args[0])
        else:
            values[node] = getattr(mpmath, node.op)(args[0])
    return values[formula]


def exact_derivatives(formula, variable, x, others):
    """Value and derivatives 1 to 3 by Cauchy's formula on a circle around x, where no 0/0 is ever met."""
    count, radius = 12, mpmath.mpf("0.01")
    with mpmath.workdps(30):
        sums = [mpmath.mpc(0)] * 4
        for j in range(count):
            turn = mpmath.expjpi(mpmath.mpf(2 * j + 1) / count)  # no point of the circle is real
            value = complex_value(formula, {**others, variable: x + radius * turn})
            sums = [s + value / turn**k for k, s in enumerate(sums)]
        return [(s / count / radius**k * mpmath.factorial(k)).real for k, s in enumerate(sums)]


@pytest.mark.parametrize("text", CASES)
def test_value_and_derivatives_one_to_three_at_and_near_the_zero(text):
    variable, zero, others = CASES[text]
    formula = formula_of(text)
    derivatives = remove_singularities([formula])
    for _ in range(3):
        derivatives.append(derivative(derivatives[-1], variable))
    points = [zero + sign * h for h in [0.0, *SMALL, *EDGES] for sign in (1, -1)]
    exact_others = {name: mpmath.mpf(value) for name, value in others.items()}
    want = np.array(
        [[float(d) for d in exact_derivatives(formula, variable, mpmath.mpf(x), exact_others)] for x in points]
    )
    got = np.array([[evaluate(d, {**others, variable: float(x)}) for d in derivatives] for x in points])
    natural = np.maximum(np.abs(want).max(axis=0), 1e-3)
    assert (np.abs(got - want) / natural).max() < 1e-10  # NaN fails too


@pytest.mark.parametrize(
    "text",
    [
        "x/y",
        "1/x",
        "cos(x)/x",  # a pole
        "sin(x)/x^2",  # half a pole is left
        "x/(1 + x)",
        "r1/r2 - r2/r1",
        "1/x + 2/sin(x)",
        "x^n/(k^n + x^n)",
        "abs(x)/x",  # a jump
        "(x + 1)/(1 - exp(-x))",
        "(V + 40)/(1 - exp(-(V + 41)/10))",
        "x/sin(y)",
        "exp(-1/x^2)/x",
    ],
)
def test_what_is_not_removable_stays_the_identical_node(text):
    formula = parse(text, {name: symbol(name) for name in ("x", "y", "r1", "r2", "k", "n", "V")})
    assert remove_singularities([formula])[0] is formula


def test_only_the_quotient_itself_is_replaced():
    names = {name: symbol(name) for name in ("V", "g", "m")}
    quotient = parse("(V + 40)/(1 - exp(-(V + 40)/10))", names)
    (alone,) = remove_singularities([quotient])
    (inside,) = remove_singularities([parse("g*m^3*(V - 50) + 0.1*(V + 40)/(1 - exp(-(V + 40)/10))*(1 - m)", names)])
    conditionals = [node for node in postorder([alone]) if node.op == "if"]
    assert len(conditionals) == 1
    assert conditionals[0] in postorder([inside])
    assert sum(node.op == "if" for node in postorder([inside])) == 1


def test_common_zeros_of_polynomials_are_divided_out_without_a_condition():
    (result,) = remove_singularities([parse("(r^3 + a*r)/r", {name: symbol(name) for name in "ra"})])
    assert all(node.op != "if" for node in postorder([result]))
    assert evaluate(result, {"r": 0.0, "a": 1.5}) == 1.5


DIVIDED_OUT = ("(x^3 + 2*x)/x", "(x^2 + a*x)/(x^3 + 2*x)", "(x^2 - 1)/(x - 1)")


@pytest.mark.parametrize("text", [t for t in CASES if "^2)^2" not in t])
def test_conditions_are_guards(text):
    (result,) = remove_singularities([formula_of(text)])
    conditions = [n.args[0] for n in postorder([result]) if n.op == "if"]
    assert bool(conditions) is (text not in DIVIDED_OUT)
    for condition in conditions:
        parts = condition.args if condition.op == "and" else (condition,)
        assert all(is_guard(part) for part in parts)


@pytest.mark.parametrize(("a", "b"), [(0.5, 20.0), (20.0, 0.5), (-50.0, 400.0)])
def test_guard_scales_with_the_parameters(a, b):
    """expm1(a x)/expm1(b x) varies over 1/max(|a|, |b|): the guard knows, whatever the parameters are."""
    formula = parse("(exp(a*x) - 1)/(exp(b*x) - 1)", {name: symbol(name) for name in "xab"})
    derivatives = remove_singularities([formula])
    for _ in range(2):
        derivatives.append(derivative(derivatives[-1], "x"))
    unit = 1 / max(abs(a), abs(b))
    exact = {"a": mpmath.mpf(a) * unit, "b": mpmath.mpf(b) * unit}  # in x / unit
    for h in (0.0, 1e-6, -0.1, 0.24, -0.26, 0.5):
        want = exact_derivatives(formula, "x", mpmath.mpf(h), exact)
        for order in range(3):
            got = evaluate(derivatives[order], {"x": h * unit, "a": a, "b": b}) * unit**order
            assert got == pytest.approx(float(want[order]), abs=1e-10 * max(1.0, abs(a / b)))


def test_zero_of_any_factor_of_an_argument_is_removed():
    names = {name: symbol(name) for name in "xy"}
    (sinc,) = remove_singularities([parse("sin(x*y)/(x*y)", names)])
    for x, y in [(0.0, 2.0), (2.0, 0.0), (0.0, 0.0), (1e-8, 1e-3)]:
        assert evaluate(sinc, {"x": x, "y": y}) == pytest.approx(1.0, abs=1e-15)
        assert evaluate(derivative(derivative(sinc, "x"), "x"), {"x": x, "y": y}) == pytest.approx(
            -(y**2) / 3, abs=1e-12
        )


def test_a_nearby_pole_narrows_the_guard():
    """exp(x) - 1 + 100 x^2 has a second zero at x = -0.0099: the polynomial must not reach there."""
    formula = parse("x/(exp(x) - 1 + 100*x^2)", {"x": symbol("x")})
    (result,) = remove_singularities([formula])
    assert evaluate(result, {"x": 0.0}) == 1.0
    for x in (-0.02, -0.005, 0.001, 0.01, 0.1):
        exact = complex_value(formula, {"x": mpmath.mpf(x)})
        assert evaluate(result, {"x": x}) == pytest.approx(float(exact), rel=1e-10)
