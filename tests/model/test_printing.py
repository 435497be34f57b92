"""Printing: what is written reads back as the identical node, with no more parentheses than needed."""

import contextlib
import math

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from contin.errors import InputError
from contin.model import printing
from contin.model.expression import PI, Expression, add, call, number, power, rebuild, symbol
from contin.model.latex import latex_name, to_latex
from contin.model.parser import parse
from contin.model.printing import to_text
from tests.model.trees import NAMES, expressions


@settings(max_examples=150, deadline=None)
@given(expressions())
@example(power(power(symbol("x"), number(2)), number(0.5)) * symbol("x"))
@example(number(math.inf) * symbol("x"))
@example(number(math.nan) + symbol("x"))
@example(power(number(0), number(-1)))
@example(symbol("x") * number(0.1 + 0.2))
def test_text_reads_back_as_the_identical_node(expression):
    assert parse(to_text(expression), NAMES) is expression


@settings(max_examples=80, deadline=None)
@given(expressions())
def test_rebuilding_a_node_from_its_operands_gives_the_node(expression):
    assert rebuild(expression, expression.args) is expression if expression.args else True


@settings(max_examples=80, deadline=None)
@given(expressions())
def test_no_pair_of_parentheses_can_be_left_out(expression):
    """Without any pair that is not a call's, the text is another formula, or none."""
    text = to_text(expression)
    opened: list[int] = []
    for i, c in enumerate(text):
        if c == "(":
            opened.append(i)
        elif c == ")":
            start = opened.pop()
            if start and (text[start - 1].isalnum() or text[start - 1] == "_"):
                continue  # a call
            shorter = text[:start] + " " + text[start + 1 : i] + " " + text[i + 1 :]
            with contextlib.suppress(InputError):
                assert parse(shorter, NAMES) is not expression


@pytest.mark.parametrize(
    "text",
    ["A - (B + 1)*x + x^2*y", "(3*a + sqrt(9*a^2 - 48*pi*b*beta))/(4*b)", "-x", "1 - x - y - s", "x/2", "0.1*x",
     "1.5*x", "1/x^2", "a/b", "2*(x + y)",
     "-(x + y)^2", "x^-0.5", "x^(1/3)", "2^-x", "r1/r2 - r2/r1", "(a + b) + c",
     "a*x^3 - b*x^5 if x*y > 0 else 0", "1 if 1 < x and x < 3 or y > 0 else 0", "min(a, b, c)", "1e-12*x"],
)  # fmt: skip
def test_formulas_print_as_an_author_writes_them(text):
    assert to_text(parse(text)) == text


def test_named_parts_are_written_by_their_names():
    r2 = parse("x^2 + y^2")
    formula = parse("mu*x - x*(x^2 + y^2)")
    assert to_text(formula, {r2: "r2"}) == "mu*x - x*r2"
    assert parse("mu*x - x*r2", {"mu": symbol("mu"), "x": symbol("x"), "r2": r2}) is formula


def test_a_deep_formula_prints_without_recursion():
    node: Expression = symbol("x")
    for _ in range(20_000):
        node = call("sin", node)
    assert len(to_text(node)) == 5 * 20_000 + 1
    assert to_latex(node).endswith(r"\right)")


def test_a_formula_that_shares_its_parts_beyond_measure_is_refused(monkeypatch):
    monkeypatch.setattr(printing, "MAX_TEXT", 100_000)
    node = symbol("x")
    for _ in range(60):
        node = call("sin", node) + call("cos", node)
    with pytest.raises(InputError, match="longer than"):
        to_text(node)


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("(3*a + sqrt(b))/(4*b)", r"\frac{3 a + \sqrt{b}}{4 b}"),
        ("-beta*r1/2", r"-\frac{\beta r_{1}}{2}"),
        ("x^2*(y + 1)", r"x^{2} \left(y + 1\right)"),
        ("exp(-x)", "e^{-x}"),
        ("x if x > 0 else -x", r"\begin{cases} x & \text{if } x > 0 \\ -x & \text{otherwise} \end{cases}"),
        ("2*pi", r"2 \pi"),
        ("log(x)/log(10)", r"\frac{\ln\left(x\right)}{\ln\left(10\right)}"),
    ],
)
def test_latex(text, latex):
    assert to_latex(parse(text)) == latex


def test_latex_names():
    assert [latex_name(n) for n in ("beta", "r1", "v_x", "Vmax", "eps", "g_Na", "omega_alpha")] == [
        r"\beta", "r_{1}", "v_{x}", r"\mathrm{Vmax}", r"\varepsilon", r"g_{\mathrm{Na}}", r"\omega_{\alpha}",
    ]  # fmt: skip


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_double_survives_being_printed(value):
    assert float(parse(to_text(number(value))).value) == value


def test_pi_and_sums_keep_their_order():
    assert to_text(add(1, symbol("x"), PI)) == "1 + x + pi"
    assert to_text(add(symbol("x"), 1, PI)) == "x + pi + 1"
