"""Random formulas for property tests."""

from fractions import Fraction

from hypothesis import strategies as st

from contin.model.expression import (
    COMPARISONS,
    PI,
    Expression,
    add,
    call,
    compare,
    if_,
    logical,
    mul,
    number,
    power,
    symbol,
)
from contin.model.vocabulary import UNARY_FUNCTIONS

NAMES = ("x", "y", "beta", "r1", "lambda")

numbers = st.one_of(
    st.integers(-12, 12),
    st.fractions(min_value=-50, max_value=50, max_denominator=1000),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([Fraction(1, 2), Fraction(-1, 3), 0.1, 1e-300, 10**30, -1, -2]),
).map(number)
leaves = st.one_of(numbers, st.sampled_from([symbol(n) for n in NAMES]), st.just(PI))


@st.composite
def expressions(draw: st.DrawFn) -> Expression:
    """A formula of up to 14 operations, whose parts may be used several times."""
    values = draw(st.lists(leaves, min_size=2, max_size=6))
    truths: list[Expression] = []
    for _ in range(draw(st.integers(0, 14))):
        a, b, c = (draw(st.sampled_from(values[-6:] + values[:3])) for _ in range(3))
        kind = draw(st.sampled_from(["add", "mul", "pow", "power", "call", "pair", "compare", "logic", "if"]))
        if kind == "add":
            values.append(add(a, b, c))
        elif kind == "mul":
            values.append(mul(a, b))
        elif kind == "pow":
            values.append(power(a, b))
        elif kind == "power":
            values.append(power(a, number(draw(st.integers(-3, 3)))))
        elif kind == "call":
            values.append(call(draw(st.sampled_from(sorted(UNARY_FUNCTIONS))), a))
        elif kind == "pair":
            values.append(call(draw(st.sampled_from(["min", "max", "atan2"])), a, b))
        elif kind == "compare" or not truths:
            truths.append(compare(draw(st.sampled_from(sorted(COMPARISONS))), a, b))
        elif kind == "logic":
            op = draw(st.sampled_from(["and", "or", "not"]))
            p, q = draw(st.sampled_from(truths)), draw(st.sampled_from(truths))
            truths.append(logical(op, p) if op == "not" else logical(op, p, q))
        else:
            values.append(if_(draw(st.sampled_from(truths)), a, b))
    return values[-1]
