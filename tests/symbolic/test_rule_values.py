"""Rules evaluated in numbers are those that are written as formulas."""

import numpy as np
import pytest

from contin.model.expression import mul, number, substitute, symbol
from contin.model.parser import parse
from contin.symbolic.averaging.cells import RADIUS, regions
from contin.symbolic.averaging.gauss_rule import angle_of, arc_rule, at_state, sampled_averages, turn_rule
from contin.symbolic.averaging.rule_values import COS, SIN, Segment, arc_values, turn_values
from contin.symbolic.averaging.switching_lines import X, Y

RADII = np.array([0.31, 1.7, 2.9])
VALUES = {"w": 1.3, "h": 0.25, RADIUS: RADII}
OMEGA, R = symbol("w"), symbol(RADIUS)


def function(text):
    return substitute([parse(text, ["x", "y", "h"])], {symbol("x"): symbol(X), symbol("y"): symbol(Y)})[0]


def integrand(formula):
    return at_state(formula, mul(R, COS), mul(number(-1), OMEGA, R, SIN))


@pytest.mark.parametrize(("text", "odd"), [("tanh(x*y) + x^3*y^2 - y", False), ("tanh(y) + x^3", True)])
@pytest.mark.parametrize("n", [6, 48])
def test_nodes_of_the_whole_turn(text, odd, n):
    f = function(text)
    formulas = turn_rule(f, OMEGA, R, n, odd)[:2]
    expected = sampled_averages(formulas, RADII, {"w": 1.3, "h": 0.25})
    np.testing.assert_allclose(turn_values(integrand(f), n, VALUES, odd), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("text", ["tanh(x) if x*y > 0 else y^2", "exp(-x^2) if x > h else sin(y)"])
@pytest.mark.parametrize("n", [8, 32])
def test_nodes_on_arcs_whose_ends_are_fixed_or_move(text, n):
    found, _ = regions(function(text), OMEGA, {"w": 1.3, "h": 0.25}, ("w", "h"))
    compared = 0
    for region in found:
        low, high = region.numbers
        radii = RADII[(low < RADII) & (high > RADII)]
        compared += len(radii)
        expected = sampled_averages(arc_rule(region.arcs, OMEGA, R, n)[:2], radii, {"w": 1.3, "h": 0.25})
        segments = [Segment(angle_of(a.start, R), angle_of(a.stop, R), integrand(a.formula)) for a in region.arcs]
        got = arc_values(segments, n, {**VALUES, RADIUS: radii})
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-13)
    assert compared >= len(RADII) - 1  # a radius may be where regions meet
