"""Derivatives of formulas: against mpmath along lines, against each other, and in effort."""

import math
from itertools import product

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import ZERO, add, call, compare, if_, mul, postorder, power, symbol
from contin.model.parser import parse
from contin.symbolic.calculus.derivatives import derivative, direction_symbols, directional, jacobian, sparse_jacobian

NAMES = ("x", "y", "a")
SCOPE = {name: symbol(name) for name in NAMES}
POINT = {"x": 0.7, "y": -0.4, "a": 1.3}

leaves = st.sampled_from([*SCOPE.values(), parse("2", {}), parse("1/3", {}), parse("-0.75", {})])
compositions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda t: t[0] + t[1]),
        st.tuples(inner, inner).map(lambda t: t[0] * t[1]),
        st.tuples(inner, st.integers(2, 5)).map(lambda t: power(t[0], t[1])),
        inner.map(lambda e: 1 / (2 + power(e, 2))),
        st.tuples(st.sampled_from(["sin", "cos", "tanh", "atan"]), inner).map(lambda t: call(t[0], t[1])),
        inner.map(lambda e: call("exp", call("sin", e))),
        inner.map(lambda e: power(2 + call("sin", e), call("cos", e))),
        st.tuples(inner, inner).map(lambda t: call("atan2", t[0], 2 + power(t[1], 2))),
    ),
    max_leaves=12,
)


def along_a_line(formula, directions, order):
    """d^order/ds^order of formula(POINT + s direction) by mpmath."""
    with mpmath.workdps(90):

        def on_line(s):
            return evaluate(formula, {n: mpmath.mpf(POINT[n]) + s * mpmath.mpf(directions[n]) for n in NAMES}, mpmath)

        return mpmath.diff(on_line, 0, order, h=mpmath.mpf(10) ** -18)


@settings(max_examples=60, deadline=None)
@given(compositions)
def test_directional_derivatives_of_random_compositions_agree_with_mpmath(formula):
    direction = {"x": 0.3, "y": -1.1, "a": 0.25}
    for order in (1, 2, 3):
        symbols = [symbol(f"d{n}") for n in NAMES]
        (form,) = directional([formula], NAMES, [symbols] * order)
        got = evaluate(
            form, {**{n: mpmath.mpf(v) for n, v in POINT.items()}, **{f"d{n}": v for n, v in direction.items()}}, mpmath
        )
        want = along_a_line(formula, direction, order)
        assert abs(got - want) <= 1e-11 * max(1, abs(want))


@settings(max_examples=40, deadline=None)
@given(compositions, compositions)
def test_jacobian_rows_are_the_single_derivatives(first, second):
    rows = jacobian([first, second], NAMES)
    for row, formula in zip(rows, (first, second), strict=True):
        assert all(entry is derivative(formula, name) for entry, name in zip(row, NAMES, strict=True))


@given(st.permutations(range(3)))
def test_third_form_is_symmetric_and_multilinear(order):
    formula = parse("x^3*y*exp(a*x) + sin(x*y)*a^2", SCOPE)
    vectors = [(0.2, 1.0, -0.3), (1.0, 0.0, 0.5), (-0.7, 0.4, 2.0)]

    def form(*given_vectors):
        symbols = [direction_symbols(k + 1, 3) for k in range(3)]
        (value,) = directional([formula], NAMES, symbols)
        env = {
            s.value: v
            for row, vector in zip(symbols, given_vectors, strict=True)
            for s, v in zip(row, vector, strict=True)
        }
        return evaluate(value, {**POINT, **env})

    assert form(*[vectors[k] for k in order]) == pytest.approx(form(*vectors), rel=1e-13)
    doubled = [tuple(2 * c for c in vectors[0]), vectors[1], vectors[2]]
    assert form(*doubled) == pytest.approx(2 * form(*vectors), rel=1e-14)


def test_directions_are_constants_even_where_they_contain_the_variables():
    x = SCOPE["x"]
    (second,) = directional([power(x, 3)], ["x"], [[x], [x]])  # 6 x * x * x, not the derivative of 3 x^2 * x
    assert evaluate(second, {"x": 1.5}) == pytest.approx(6 * 1.5**3)


def test_mixed_partial_derivatives_commute():
    formula = parse("atan2(x, y)*exp(a*x) + x^a/y", SCOPE)
    for first, second in product(NAMES, repeat=2):
        one = derivative(derivative(formula, first), second)
        other = derivative(derivative(formula, second), first)
        point = {"x": 0.7, "y": 0.4, "a": 1.3}
        assert evaluate(one, point) == pytest.approx(evaluate(other, point), rel=1e-12)


def test_conditions_are_not_differentiated():
    x, y = SCOPE["x"], SCOPE["y"]
    formula = parse("x^2 if x*y > 1 else y", SCOPE)
    assert derivative(formula, "x") is if_(formula.args[0], 2 * x, ZERO)
    assert derivative(formula, "y") is if_(formula.args[0], ZERO, parse("1", {}))
    assert derivative(call("min", x, y), "y") is if_(compare("<=", x, y), ZERO, parse("1", {}))


def test_only_the_entries_that_depend_are_there():
    formulas = [parse(text, SCOPE) for text in ("x*y", "a", "3", "sign(x) + y")]
    assert set(sparse_jacobian(formulas, NAMES)) == {(0, 0), (0, 1), (1, 2), (3, 1)}


def test_a_long_sum_costs_what_its_terms_cost():
    """d/dx_j of a sum of 3000 terms touches the terms with x_j only: about 5 new nodes an entry, not 3000."""
    x = [symbol(f"x{i}") for i in range(3000)]
    total = add(*(call("sin", mul(x[i], x[(i + 1) % 3000])) for i in range(3000)))
    entries = sparse_jacobian([total], [f"x{i}" for i in range(3000)])
    assert len(entries) == 3000
    assert all(len(entry.args) == 2 for entry in entries.values())
    assert len(postorder(entries.values())) <= 9 * 3000  # measured 21000: products, cosines and factors included
    env = {f"x{i}": math.sin(i) for i in range(3000)}
    values = evaluate_all([entries[0, 0], entries[0, 1234]], env)
    s = [env[f"x{i}"] for i in range(3000)]
    assert values[1] == pytest.approx(math.cos(s[1233] * s[1234]) * s[1233] + math.cos(s[1234] * s[1235]) * s[1235])


def test_deep_formulas_do_not_exhaust_the_stack():
    formula, inner, want = SCOPE["x"], 0.5, 1.0
    for _ in range(3000):
        formula = call("sin", formula + SCOPE["x"])
        inner, want = math.sin(inner + 0.5), math.cos(inner + 0.5) * (want + 1)
    assert evaluate(derivative(formula, "x"), {"x": 0.5}) == pytest.approx(want, rel=1e-12)


def test_direction_of_wrong_length_is_refused():
    with pytest.raises(ValueError, match="one component for each of 3 names; got 2"):
        directional([SCOPE["x"]], NAMES, [direction_symbols(1, 2)])
