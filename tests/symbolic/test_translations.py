"""Shift symmetries: proved where they are, and named where a line of equilibria stops a branch."""

from __future__ import annotations

from fractions import Fraction

import pytest

import contin
from contin.errors import NoSolutionError, NotFiniteError
from contin.symbolic.passes.translations import translations
from tests.problems.follow import model


def test_phases_that_enter_by_their_differences_can_be_shifted_together():
    equations = {"x": "1 + a*sin(y - x)", "y": "a + sin(x - y)*cos(2*(x - y))", "z": "-z + cos(x - y)"}
    assert translations(model(equations, dict.fromkeys("xyz", 0.1), {"a": 1.0})) == ({"x": 1, "y": 1},)


def test_a_direction_may_have_weights_and_there_may_be_several():
    equations = {"x": "(2*x - y)^2*a", "y": "exp(y - 2*x)", "z": "1"}
    assert translations(model(equations, dict.fromkeys("xyz", 0.1), {"a": 1.0})) == (
        {"x": Fraction(1), "y": Fraction(2)}, {"z": Fraction(1)},
    )  # fmt: skip


def test_what_only_looks_like_one_is_none():
    equations = {"x": "a*sin(y - x) + 1e-14*x", "y": "sin(x - y)"}
    assert translations(model(equations, {"x": 0.1, "y": 0.3}, {"a": 1.0})) == ()
    assert translations(contin.load("brusselator")) == ()


def test_a_branch_that_cannot_leave_a_line_of_equilibria_names_the_symmetry():
    line = model({"x": "a*sin(y - x)", "y": "2*a*sin(x - y)*cos(x - y)"}, {"x": 0.2, "y": 0.1}, {"a": 1.0})
    with pytest.raises(NotFiniteError, match="do not change when x, y are shifted together"):
        contin.continuation(contin.equilibrium(line), "a", (0.5, 2.0))


def test_running_phases_have_no_rest_and_the_message_says_why():
    running = model({"x": "1 + a*sin(y - x)", "y": "1 + a*sin(x - y)"}, {"x": 0.0, "y": 0.3}, {"a": 1.0})
    with pytest.raises(NoSolutionError, match="shifted together"):
        contin.find_start(running)
