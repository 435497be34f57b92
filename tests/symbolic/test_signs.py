"""Formulas that the rules of signs show to be positive, and what that spares."""

from __future__ import annotations

import pytest

from contin.model.parser import parse
from contin.symbolic.calculus import remove_singularities as passed
from contin.symbolic.calculus.signs import is_positive

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    "text",
    ["1 + x^2", "exp(x)", "2 + abs(x)*y^4", "cosh(x) + x^2*y^2", "sqrt(1 + x^2)", "max(y, 1)", "min(1 + x^4, 3)"],
)
def test_positive_formulas_are_told(text):
    assert is_positive(parse(text, ["x", "y"]))


@pytest.mark.parametrize(
    "text", ["x^2", "1 - x^2", "1 + x", "x", "1 + x^3", "abs(x)", "min(1, y)", "1 - exp(x)", "-2", "0", "(1 + x)^3"]
)
def test_what_may_vanish_or_be_negative_is_not(text):
    assert not is_positive(parse(text, ["x", "y"]))


@pytest.mark.parametrize(("bottom", "most"), [("1 + {c}*x^4", 0), ("{c}*x^2 - 1", 12)])
def test_the_work_for_a_sum_grows_with_its_terms_not_with_their_square(bottom, most, monkeypatch):
    """The average over 40 nodes of x^2/(1 + x^4): hundreds of nodes took minutes."""
    expanded, expand = [], passed.expand
    monkeypatch.setattr(passed, "expand", lambda *a: expanded.append(1) or expand(*a))
    nodes = 40
    (total,) = [parse(" + ".join(f"{k}*x^2/({bottom.format(c=k)})" for k in range(1, nodes)), ["x"])]
    assert passed.remove_singularities([total]) == [total]
    assert len(expanded) <= most * nodes
