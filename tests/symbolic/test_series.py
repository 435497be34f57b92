"""Laurent series of formulas against mpmath's Taylor coefficients and closed forms."""

from fractions import Fraction

import mpmath
import pytest

from contin.model.evaluate import evaluate
from contin.model.expression import as_expression, symbol
from contin.model.parser import parse
from contin.symbolic.calculus.series import expand
from contin.symbolic.calculus.series_arithmetic import NotAnalyticError
from contin.symbolic.calculus.series_functions import _RULES

SCOPE = {name: symbol(name) for name in "wab"}
AT_ONE = ("log", "log10", "sqrt")  # not analytic at 0
INNER = ["{c} + w", "{c} + 1/3 + w/2 - w^2", "{c} + a*w + b*w^2", "{c} + a + w", "{c} + sin(w)/(2 - w)"]


@pytest.mark.parametrize("name", sorted(_RULES))
@pytest.mark.parametrize("inner", INNER)
def test_series_of_functions_agree_with_mpmath(name, inner):
    formula = parse(f"{name}({inner.format(c=1 if name in AT_ONE else 0)})", SCOPE)
    others = {"a": mpmath.mpf("0.3"), "b": mpmath.mpf("-0.7")}
    with mpmath.workdps(40):
        got = [evaluate(as_expression(c), others, mpmath) for c in expand(formula, "w", 8).terms]
        want = mpmath.taylor(lambda x: evaluate(formula, {**others, "w": x}, mpmath), 0, 7)
        assert len(got) == 8
        assert max(abs(g - t) for g, t in zip(got, want, strict=True)) < mpmath.mpf(10) ** -30


@pytest.mark.parametrize(
    ("text", "start", "terms"),
    [
        ("w/(1 - exp(-w))", 0, [1, Fraction(1, 2), Fraction(1, 12), 0, Fraction(-1, 720)]),  # Bernoulli numbers
        ("1/sin(w) - 1/w", 1, [Fraction(1, 6), 0, Fraction(7, 360)]),
        ("1/w^2 + 1/w", -2, [1, 1, 0]),
        ("(1 + w)^(-3)", 0, [1, -3, 6, -10]),
        ("sqrt(1 + w)", 0, [1, Fraction(1, 2), Fraction(-1, 8), Fraction(1, 16)]),
        ("2*3^0*w^5/w^7*cos(w)", -2, [2, 0, -1, 0, Fraction(1, 12)]),
    ],
)
def test_exact_coefficients(text, start, terms):
    series = expand(parse(text, SCOPE), "w", 10).stripped()
    assert series.start == start
    assert list(series.terms[: len(terms)]) == terms


@pytest.mark.parametrize(
    "text", ["abs(w)", "sqrt(w)", "log(w)", "w^0.5", "1/sqrt(w)", "exp(1/w)", "sign(w + 1)", "1 if w > 0 else 2"]
)
def test_what_has_no_series_is_refused(text):
    with pytest.raises(NotAnalyticError):
        expand(parse(text, SCOPE), "w", 6)
