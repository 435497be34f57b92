"""Switching functions of piecewise systems."""

import numpy as np
import pytest

from contin.lowering import compile_system
from contin.model.expression import symbol
from contin.model.parser import parse
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.remove_singularities import remove_singularities

from .systems import Equations, compiled


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x + y", []),
        ("1 if x > y else 0", ["x - y"]),
        ("1 if x^2 > 4 and not y < a else 0", ["x^2 - 4", "y - a"]),
        ("abs(x - a)", ["x - a"]),
        ("sign(x) + heaviside(y)", ["x", "y"]),
        ("min(x, y) + max(x, 2)", ["x - y", "x - 2"]),
        ("(1 if x < y else 2) + (3 if y < x else 4) + abs(2*x - 2*y)", ["x - y"]),  # equal up to sign and scale
        ("1 if abs(x) < 1 else 0", ["abs(x) - 1"]),  # x = 0 changes no formula
        ("2 if 3 < 4 else x", []),
        ("abs(sin(3))", []),
        ("x/sin(x) + y/(1 - exp(-y))", []),  # guards of removable singularities are no switchings
        ("x^a", []),
    ],
)
def test_switching_functions(text, expected):
    system = compiled({"x": text, "y": "0"}, ["a"])
    point = np.random.default_rng(5).uniform(0.5, 2, size=3)
    assert system.n_switches == len(expected)
    wanted = [compiled({"x": e, "y": "0"}, ["a"]).value(point[:2], point[2:])[0] for e in expected]
    np.testing.assert_allclose(system.switches(point[:2], point[2:]), wanted, rtol=1e-14)
    assert (system.switches_address == 0) == (not expected)


def test_guards_stay_out_of_systems_made_from_derivatives():
    """The variational equation of a model with removable singularities and symbolic powers is smooth too."""
    scope = {name: symbol(name) for name in ("x", "a", "v")}
    (f,) = remove_singularities([parse("x/(1 - exp(-x)) + x^a + log(1 + x^4)/x", scope)])
    made = Equations(("x", "v"), ("a",), (f, derivative(derivative(f, "x"), "a") * scope["v"]))
    assert compile_system(made).n_switches == 0


def test_switching_functions_of_a_forced_system_may_depend_on_time():
    system = compiled({"x": "heaviside(sin(t)) - x"}, forcing="2*pi")
    np.testing.assert_allclose(system.switches([0.3], [2.0]), [np.sin(2.0)])
