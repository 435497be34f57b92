from fractions import Fraction

import numpy as np
import pytest
import sympy

from contin.model.evaluate import evaluate
from contin.model.expression import number, symbol
from contin.model.parser import parse
from contin.symbolic.calculus.sympy_bridge import BridgeError, from_sympy, to_sympy

FORMULAS = [
    "x^3/(1 + x^4) - 2*x/3",
    "sin(x)*cos(y)^2 + tan(x/5)",
    "asin(x/9) + acos(x/9) - atan(x) + atan2(y, x)",
    "sinh(x) - cosh(y) + tanh(x*y)",
    "exp(-x) + expm1(x) + log(2 + x) + log1p(y^2) + log10(y)",
    "sqrt(x + y)/sqrt(y) - 1/sqrt(x + 3)",
    "abs(x - y) + sign(x) + heaviside(y) + min(x, y, 1) - max(x, 2*y)",
    "x if x > y else y^2 if x*y < 1 and not x == 0 else -1",
    "x^y + pi*x^(-2) + 0.1",
]


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_there_and_back_has_the_same_values(text):
    node = parse(text)
    back = from_sympy(to_sympy(node))
    chance = np.random.default_rng(5)
    for x, y in chance.uniform(0.2, 1.8, (20, 2)).tolist():
        env = {"x": x, "y": y}
        assert evaluate(back, env) == pytest.approx(evaluate(node, env), rel=1e-13)


def test_numbers_cross_exactly_and_any_name_is_only_a_label():
    assert to_sympy(number(Fraction(1, 3))) == sympy.Rational(1, 3)
    assert from_sympy(sympy.Rational(22, 7)) is number(Fraction(22, 7))
    for name in ("I", "E", "beta", "lambda", "__import__", "S"):
        there = to_sympy(symbol(name))
        assert there.is_Symbol
        assert from_sympy(there) is symbol(name)
    assert from_sympy(to_sympy(number(0.1234567890123456789))) is number(0.1234567890123456789)


@pytest.mark.parametrize("value", [sympy.I, sympy.gamma(sympy.Symbol("x")), sympy.zoo])
def test_what_the_grammar_lacks_is_refused(value):
    with pytest.raises(BridgeError, match="the grammar has no"):
        from_sympy(value)
