"""Values and first derivatives in numbers, and the sentence about values that are not finite."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.model.dual import directional
from contin.model.evaluate import evaluate
from contin.model.explain import explain_not_finite
from contin.model.expression import call, symbol
from contin.model.parser import parse
from contin.model.vocabulary import UNARY_FUNCTIONS
from tests.model.trees import NAMES, expressions

POINT = dict(zip(NAMES, (0.7, -1.3, 2.9, 0.31, -0.2), strict=True))
PLACES = {"asin": 0.4, "acos": 0.4, "acosh": 1.7, "atanh": 0.4, "log": 2.3, "log10": 2.3, "log1p": 0.7, "sqrt": 2.3}


@settings(max_examples=60, deadline=None)
@given(expressions())
def test_double_precision_agrees_with_fifty_digits_where_the_formula_is_tame(expression):
    value = evaluate(expression, POINT)
    nearby = evaluate(expression, {n: v * (1 + 1e-9) for n, v in POINT.items()})
    if not math.isfinite(value) or abs(nearby - value) > 1e-7 * abs(value):
        return  # the formula itself loses all digits, or jumps
    with mpmath.workdps(50):
        exact = evaluate(expression, {n: mpmath.mpf(v) for n, v in POINT.items()}, mpmath)
    assert value == pytest.approx(float(exact), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("name", sorted(UNARY_FUNCTIONS - {"factorial"}))  # of whole numbers only
def test_each_function_and_its_derivative_agree_with_mpmath(name):
    x = PLACES.get(name, -0.8)
    formula = call(name, symbol("x"))
    with mpmath.workdps(30):
        value = evaluate(formula, {"x": mpmath.mpf(x)}, mpmath)
        slope = mpmath.diff(lambda s: evaluate(formula, {"x": s}, mpmath), mpmath.mpf(x))
    assert evaluate(formula, {"x": x}) == pytest.approx(float(value), rel=1e-14)
    assert directional([formula], {"x": x}, {"x": 1.0})[0] == pytest.approx(float(slope), rel=1e-12, abs=1e-12)


def test_factorials_and_remainders():
    n = symbol("x")
    for k in (0, 1, 5, 21, 22, 170):
        assert evaluate(call("factorial", n), {"x": float(k)}) == float(math.factorial(k))
        assert evaluate(call("factorial", k), {}) == float(math.factorial(k))
    assert evaluate(call("factorial", n), {"x": 171.0}) == math.inf
    assert math.isnan(evaluate(call("factorial", n), {"x": 2.5}))
    assert math.isnan(evaluate(parse("factorial(-1)"), {}))
    for a, b, rest in ((7, 3, 1), (-7, 3, 2), (7, -3, -2), (-7, -3, -1), (7.5, 2, 1.5)):
        assert evaluate(call("mod", a, b), {}) == evaluate(parse("mod(x, y)"), {"x": float(a), "y": float(b)}) == rest
    assert math.isnan(evaluate(parse("mod(x, 0)"), {"x": 1.0}))
    assert directional([parse("mod(x, y)")], {"x": 7.0, "y": 3.0}, {"x": 1.0, "y": 1.0}) == [1.0 - 2.0]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.2, 2.0), min_size=6, max_size=6))
def test_directional_derivative_is_the_slope_along_the_direction(numbers):
    formula = parse("x^y*atan2(y, x) + min(x, y)*max(2*x, y) - x*y/(x + y^2) + (x^3 if x > y else y^2)")
    (x, y, a, b), h = numbers[:4], 1e-6
    if min(abs(x - y), abs(2 * x - y)) < 1e-3:
        return  # a kink
    slope = directional([formula], {"x": x, "y": y}, {"x": a, "y": b})[0]
    ends = [evaluate(formula, {"x": x + s * a, "y": y + s * b}) for s in (-h, h)]
    assert slope == pytest.approx((ends[1] - ends[0]) / (2 * h), rel=1e-6, abs=1e-6)


def test_values_follow_ieee_arithmetic_and_never_raise():
    env = {"x": 0.0, "y": -2.0, "big": 1e300}
    values = [
        evaluate(parse(t), env) for t in ("1/x", "log(x)", "log(y)", "sqrt(y)", "exp(big)", "y^0.5", "big^2", "x/x^2")
    ]
    np.testing.assert_equal(values, [math.inf, -math.inf, math.nan, math.nan, math.inf, math.nan, math.inf, math.inf])
    assert evaluate(parse("1 if x > 0 else 2"), env) == 2
    assert evaluate(parse("1/x if x > 0 else 2"), env) == 2  # the other branch does not matter


@pytest.mark.parametrize(
    ("formula", "sentence"),
    [
        ("y + x/(a - b)", "equation x: 'x/(a - b)' is infinite: division by zero, 'a - b' = 0"),
        ("3*log(y)", "equation x: 'log(y)' is not a number: logarithm of a negative number, 'y' = -2"),
        ("sqrt(y - 1)^2", "'sqrt(y - 1)' is not a number: square root of a negative number, 'y - 1' = -3"),
        ("exp(1000*x)/2", "'exp(1000*x)' is infinite: overflow, '1000*x' = 3000"),
        ("(y)^1.5", "'y^1.5' is not a number: a power that is no integer, of a negative number, 'y' = -2"),
        ("asin(x)", "asin outside [-1, 1], 'x' = 3"),
        ("1/(x - 3)^2 if x > 0 else log(y)", "'1/(x - 3)^2' is infinite: division by zero, 'x - 3' = 0"),
    ],
)
def test_the_innermost_part_that_fails_is_named_with_its_numbers(formula, sentence):
    env = {"x": 3.0, "y": -2.0, "a": 1.0, "b": 1.0}
    text = explain_not_finite({"fine": parse("x + y"), "x": parse(formula)}, env)
    assert sentence in text
    assert "x = 3" in text or "y = -2" in text


def test_nothing_is_said_about_finite_equations():
    assert explain_not_finite({"x": parse("1/x if x > 0 else 0")}, {"x": 0.0}) == ""
