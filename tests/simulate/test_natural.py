"""Natural sizes of states at a start, where derivatives at rest are rounding or vanish: lengths in closed form."""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from contin.simulate.natural import natural_metric


def sizes(equations, states, **parameters):
    model = Model("rest", states=dict.fromkeys(equations, 0.0), parameters=parameters, equations=equations)
    start = contin.equilibrium(model)
    return natural_metric(start.system, np.array(states, dtype=float), np.asarray(start.p, dtype=float)).states


def test_a_state_that_is_zero_but_for_rounding_has_the_size_of_one_that_is_zero():
    """z' = -z - x^2 bends as much as it slopes at a distance of x itself, which says nothing (it was the size)."""
    equations = {"x": "-x - y - x*(x^2 + y^2)", "y": "x - y - y*(x^2 + y^2)", "z": "1 - z - x^2 - y^2"}
    np.testing.assert_allclose(sizes(equations, [1e-33, -3e-33, 1.0]), sizes(equations, [0.0, 0.0, 1.0]), rtol=1e-6)


@pytest.mark.parametrize("unit", [1.0, 1e-9, 1e12])
def test_values_say_how_large_a_state_is_where_derivatives_at_rest_vanish(unit):
    """p x - x^5: x^4 = p; a second spring behind a clearance: c (x - g) = k x."""
    assert sizes({"x": "p*x - x*(x/s)^4"}, [0.0], p=16.0, s=unit)[0] == pytest.approx(2.0 * unit, rel=1e-2)
    spring = {"x": "-k*x - c*max(x - g*s, 0)"}
    assert sizes(spring, [0.0], k=1.0, c=3.0, g=0.5, s=unit)[0] == pytest.approx(0.75 * unit, rel=1e-2)
