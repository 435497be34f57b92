"""The grammar of formulas: what binds tighter, what is exact, and what is said about mistakes."""

import time
from fractions import Fraction

import pytest

from contin.errors import ExpressionError
from contin.model.evaluate import evaluate
from contin.model.expression import add, call, mul, number, numeric_value, power, symbol
from contin.model.parser import MAX_DEPTH, parse
from contin.model.scope import Function, placeholders

X = {"x": 3.0, "y": 5.0, "z": 7.0}

PRECEDENCE = [  # formula, value by hand at x = 3, y = 5, z = 7
    ("-x^2", -9.0),
    ("(-x)^2", 9.0),
    ("2*x^2 + 1", 19.0),
    ("2*x**2+1", 19.0),
    ("2^-1", 0.5),
    ("2^x^2", 512.0),
    ("(2^x)^2", 64.0),
    ("2^-x^2", 2.0**-9),
    ("x - y - z", -9.0),
    ("x - (y - z)", 5.0),
    ("x/y/z", 3.0 / 35.0),
    ("x/y*z", 4.2),
    ("x/(y*z)", 3.0 / 35.0),
    ("x*-y", -15.0),
    ("x--y", 8.0),
    ("+x - +y", -2.0),
    ("1/2*x", 1.5),
    ("-x*y + z", -8.0),
    ("-2^2", -4.0),
    ("1 if x < y < z else 0", 1.0),
    ("1 if x < z < y else 0", 0.0),
    ("1 if not x > y and y < z else 0", 1.0),
    ("1 if not (x > y and y < z) else 0", 1.0),
    ("1 if x > y or x < y and z < y else 0", 0.0),
    ("1 if (x > y or x < y) and y < z else 0", 1.0),
    ("x + 1 if x > y else y + 1", 6.0),
    ("x + (1 if x > y else y) + 1", 9.0),
    ("1 if x > y else 2 if y > z else 3", 3.0),
    ("(1 if x > 1 else 2) if y > z else 3", 3.0),
    ("min(x, y, z) + max(z, y, x)", 10.0),
    ("atan2(0, -1)/pi", 1.0),
    ("heaviside(0) + sign(-x) + abs(-y)", 4.5),
    ("1 if x + y == 8 and x != y and x <= 3 and y >= 5 else 0", 1.0),
    (".5*x + 1.e1 + 2E-1", 11.7),
]


@pytest.mark.parametrize(("text", "value"), PRECEDENCE, ids=[t for t, _ in PRECEDENCE])
def test_precedence_agrees_with_hand_values(text, value):
    assert evaluate(parse(text, list(X)), X) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "exact"),
    [("0.1", (1, 10)), ("1e-3", (1, 1000)), ("1/3", (1, 3)), ("12345678901234567890", (12345678901234567890, 1)),
     ("2^-3", (1, 8)), ("0.1 + 0.2", (3, 10)), ("-2.50", (-5, 2))],
)  # fmt: skip
def test_decimals_and_their_arithmetic_are_exact(text, exact):
    assert numeric_value(parse(text)) == Fraction(*exact)


def test_a_decimal_with_more_digits_than_a_double_keeps_is_the_double():
    assert numeric_value(parse("2.6666666666666665")) == 8.0 / 3.0
    assert isinstance(numeric_value(parse("2.6666666666666665")), float)


def test_declared_names_win_over_constants_and_functions():
    names = ["I", "E", "S", "N", "Q", "beta", "gamma", "lambda", "e", "in", "exp", "min", "t", "π"]
    for name in names:
        assert parse(name, names) is symbol(name)
    assert parse("exp*exp(exp)", names) is mul(symbol("exp"), call("exp", symbol("exp")))


def test_formulas_build_the_nodes_that_python_operators_build():
    x, y = symbol("x"), symbol("y")
    assert parse("a*x^2 - y/3", ["a", "x", "y"]) is symbol("a") * x**2 - y / 3
    assert parse("x + y + 1") is add(x, y, 1)
    assert parse("sqrt(x)^2*x^-1") is mul(power(call("sqrt", x), 2), power(x, -1))


def test_ten_thousand_terms_and_factors_are_read_in_linear_time():
    names = [f"v{i}" for i in range(50)]
    seconds = []
    for n in (2_000, 10_000):
        text = " + ".join(f"{i}*{names[i % 50]}^{i % 7 + 2}*sin({names[i % 49]})" for i in range(1, n))
        began = time.process_time()
        parse(text, names)
        seconds.append(time.process_time() - began)
    assert seconds[1] < 5 * 2.5 * seconds[0] + 0.1  # quadratic would be 25 times


@pytest.mark.parametrize(
    "text",
    ["(" * 10_000 + "x", "-" * 10_000 + "x", "x" + "^x" * 10_000, "sin(" * 10_000, "not " * 10_000 + "x > 1",
     "1 if x > 0 else " * 10_000 + "1"],
)  # fmt: skip
def test_deep_nesting_is_an_error_of_ours_and_not_a_recursion_error(text):
    with pytest.raises(ExpressionError, match=f"nested deeper than {MAX_DEPTH}"):
        parse(text, ["x"])


@pytest.mark.parametrize("text", ["9^9^9^9^9^9", "10^10^10", "2^(2^(2^(2^(2^2))))", "1e308*1e308", "(1/3)^999999999"])
def test_towers_of_numbers_stay_small(text):
    began = time.process_time()
    parse(text)
    assert time.process_time() - began < 0.5


MISTAKES = [  # formula over x, y, beta and function f(u, v); position; what the message says
    ("", 0, "the formula is empty"),
    ("x +", 3, "ends too early"),
    ("x = 1", 2, "write '=='"),
    ("2x", 1, "for a product write '*'"),
    ("x y", 2, "for a product write '*'"),
    ("x(y)", 0, r"x is not a function; for a product write x\*"),
    ("2(x)", 1, "for a product write '*'"),
    ("sec(x)", 0, r"write 1/cos\(x\)"),
    ("ln(x)", 0, r"write log\(x\)"),
    ("Sin(x)", 0, r"write sin\("),
    ("sin", 0, r"sin is a function: write sin\("),
    ("bate*x", 0, "did you mean 'beta'"),
    ("X", 0, "did you mean 'x'"),
    ("i*x", 0, "complex numbers are not available"),
    ("PI", 0, "write pi"),
    ("x²", 1, r"write \^2"),
    ("x × y", 2, r"write '\*'"),
    ("x.y", 1, "names may not contain a dot"),
    ("x && y", 2, "write 'and'"),
    ("|x|", 0, "abs"),
    ("x ? y : 1", 2, "u if c else v"),
    ("(x", 0, r"'\(' is never closed"),
    ("sin(x", 3, r"'\(' is never closed"),
    ("max(x - 1", 3, r"a comma ends a formula in YAML: put this one in quotes"),
    ("x)", 1, r"'\)' without '\('"),
    ("x, y", 1, "only between the arguments"),
    ("sin(x, y)", 0, "sin takes 1 argument, got 2"),
    ("min(x)", 0, "min takes 2 or more arguments, got 1"),
    ("f(x)", 0, r"f\(u, v\) takes 2 arguments, got 1"),
    ("f + 1", 0, r"f is a function: write f\(u, v\)"),
    ("sin()", 4, "sin needs an argument"),
    ("x > 1", 0, "a condition is not a number"),
    ("1 + (x > 1)", 4, "a condition cannot stand as an operand of"),
    ("x if y else 1", 5, "write a comparison"),
    ("1 if x > 1", 2, "'if' without 'else'"),
    ("1 else 2", 2, "'else' without 'if'"),
    ("x > 1 and y", 10, "write a comparison"),
    ("x < not y", 4, "in parentheses"),
    ("* x", 0, "expected a number, a name"),
    ("1e999", 0, "too large for double precision"),
    ("1e-999", 0, "too small for double precision"),
    ("x\x00", 1, r"U\+0000"),
    ("__import__(x)", 0, "unknown function '__import__'"),
    ("'os'", 0, "formulas have no strings"),
    ("x.__class__", 1, "names may not contain a dot"),
    ("x @ y", 2, "unexpected character '@'"),
    ("lambda x", 0, "unknown name 'lambda'"),
]


@pytest.mark.parametrize(("text", "position", "message"), MISTAKES, ids=[repr(t) for t, _, _ in MISTAKES])
def test_mistakes_are_named_with_their_place_and_what_to_write(text, position, message):
    u, v = placeholders("f", ("u", "v"))
    functions = {"f": Function.make("f", ("u", "v"), "u - v", u - v, False)}
    with pytest.raises(ExpressionError, match=message) as caught:
        parse(text, ["x", "y", "beta"], functions)
    assert caught.value.position == position


def test_function_arguments_are_put_in_all_at_once():
    u, v = placeholders("f", ("u", "v"))
    functions = {"f": Function.make("f", ("u", "v"), "u - 2*v", u - 2 * v, False)}
    # swapping names one after the other would turn f(v, u) into v - 2*v or u - 2*u
    assert parse("f(v, u)", ["u", "v"], functions) is symbol("v") - 2 * symbol("u")
    assert evaluate(parse("f(f(1, 2), f(3, 4))", [], functions), {}) == -3 - 2 * -5


def test_a_number_too_long_to_be_meant_is_refused_quickly():
    with pytest.raises(ExpressionError, match="a number of 5000 characters"):
        parse("1" * 5000)
    assert parse("1e-300") is number(Fraction(1, 10**300))
