"""Half-branches at degenerate points against curves whose tangents and powers are known."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

import contin
from contin.machine import elementary
from contin.problems.equilibria.branching.circle import CircleZeros
from contin.problems.equilibria.branching.halves import fan
from contin.problems.equilibria.branching.reduced import ReducedEquations
from contin.problems.equilibria.scaled import ScaledSystem


def fan_of(equations, corank, parameter="p"):
    """The fan at the origin in the metric of a range of length 1 and states of size 1."""
    states = dict.fromkeys(equations, 0.0)
    model = contin.Model("case", states=states, parameters={parameter: 0.0}, equations=equations)
    problem = contin.equilibrium(model, states, {parameter: 0.0}).problem(parameter)
    return fan(ReducedEquations.at(ScaledSystem(problem, np.ones(len(states) + 1)), np.zeros(len(states) + 1), corank))


def powers(found):
    """The powers of the halves of each curve as fractions, lines without one."""
    curves = []
    for curve in found.curves:
        known = [h.power for h in curve if np.isfinite(h.power)]
        curves.append((len(curve), Fraction(known[0]).limit_denominator(5) if known else None))
    return sorted(curves, key=str)


@pytest.mark.parametrize(
    ("equation", "expected", "contact"),
    [("x*(x - p^2)", [(2, Fraction(2)), (2, None)], 2),
     ("x*(x - p^3)", [(2, Fraction(3)), (2, None)], 3),
     ("x*(x - p^4)", [(2, Fraction(4)), (2, None)], 4),
     ("(p - x^2)*(p + x^2)", [(2, Fraction(2)), (2, Fraction(2))], 2),
     ("x^2 - p^3", [(2, Fraction(3, 2))], None),
     ("x^3 - p^4", [(2, Fraction(4, 3))], None),
     ("x^3 - p^5", [(2, Fraction(5, 3))], None),
     ("x^2 + p^2", [], None),
     ("p*x*(x - p)", [(2, None)] * 3, None),
     ("x*(x^2 - p^3)*(x + p)", [(2, Fraction(3, 2)), (2, None), (2, None)], None)],
)  # fmt: skip
def test_halves_of_plane_curves_are_paired_as_their_powers_say(equation, expected, contact):
    """The germ of a plane curve is the union of its Puiseux branches: x = c p^(a/b), one curve of two halves each."""
    found = fan_of({"x": f"-({equation})"}, 1)
    assert found is not None
    assert powers(found) == sorted(expected, key=str)
    assert (None if found.contact() is None else found.contact().order) == contact


def test_halves_lie_on_both_sides_of_a_point_with_two_critical_directions():
    """x' = -m x + 10 x^3 + 10 y^2, y' = -y (m + x^2 / 2): y ~ |m|^(3/2) on a cusp that leaves to x < 0, m < 0."""
    found = fan_of({"x": "-m*x + 10*x^3 + 10*y^2", "y": "-y*(m + 0.5*x^2)"}, 2, "m")
    assert found is not None
    cusp = [curve for curve in found.curves if all(abs(h.point[1]) > 1e-4 for h in curve)]
    assert len(found.curves) == 3
    assert len(cusp) == 1
    for half in cusp[0]:
        x, y, m = half.near
        assert m == pytest.approx(-0.5 * x * x)
        assert y * y == pytest.approx(-1.05 * x**3, rel=1e-9)


def test_every_half_is_a_solution_and_its_tangent_is_the_limit():
    found = fan_of({"x": "-x*(x - p^2)", "y": "x - y"}, 1)
    assert found is not None
    for curve in found.curves:
        for half in curve:
            x, y, p = half.point
            assert abs(x * (x - p * p)) < 1e-16
            assert y == pytest.approx(x)
            np.testing.assert_allclose(half.direction, [0.0, 0.0, np.sign(p)], atol=1e-6)


def test_an_equation_that_is_rough_all_around_the_circle_is_given_up_after_a_bounded_number_of_values():
    """It was halved 40 times everywhere: 7 minutes, where a metric was wrong by 1e9."""
    count = [0]

    def value(c, v):
        count[0] += 1
        h = np.array([elementary.sin(1e12 * c[0] + 1e11 * c[1])])
        return SimpleNamespace(h=h, slopes=np.array([[1e12, 1e11]]), noise=1e-16, v=v)

    reduced = SimpleNamespace(y=np.zeros(3), kernel=np.eye(3, 2), value=value)
    assert CircleZeros(reduced, 1.0).points() is None
    assert count[0] <= 4000
