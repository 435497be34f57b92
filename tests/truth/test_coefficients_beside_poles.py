"""Coefficients beside their poles: a further multiplier near 1 at a period doubling, known in closed form.

w0 -> (1 - d) w0 + ..., w1 -> -(1 + p) w1 + .4 w0 w1 + .2 w1^3 with w0' = .7 w1^2: w0 = (.7/d) w1^2 on the centre
manifold, so that w1 -> -w1 + (.2 + .28/d) w1^3. In u = T w, det T = 1, the eigenvector (2, 1) has the length sqrt(5).
"""

from types import SimpleNamespace

import numpy as np
import pytest

import contin
from contin.problems.equilibria.special_points import _balancing_units

W0, W1 = "((u - U) - 2*(v - V))", "(7*(v - V) - 3*(u - U))"
ROW0 = f"(1 - d)*{W0} + 0.3*{W0}^2 + 0.7*{W1}^2"
ROW1 = f"-(1 + p)*{W1} + 0.4*{W0}*{W1} + 0.2*{W1}^3"


@pytest.mark.parametrize("place", [(0.0, 0.0), (7.3, -11.7)])
@pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6, 1e-8])
def test_the_error_of_a_coefficient_covers_what_its_pole_makes_of_rounding(distance, place):
    U, V = place
    model = contin.load({
        "contin": 1, "name": "beside-a-pole", "kind": "map", "states": {"u": U, "v": V},
        "parameters": {"p": {"value": -0.3, "range": [-0.3, 0.3]}, "d": distance, "U": U, "V": V},
        "equations": {"u": f"U + 7*({ROW0}) + 2*({ROW1})", "v": f"V + 3*({ROW0}) + ({ROW1})"},
    })  # fmt: skip
    point = contin.continuation(contin.equilibrium(model), "p")["PD1"]
    form, exact = point.normal_form, (0.2 + 0.28 / distance) / 5.0
    assert abs(form["c"] - exact) <= form["errors"]["c"]
    expected = "supercritical" if form["errors"]["c"] < exact else "degenerate"
    assert form["criticality"] == expected
    if distance >= 1e-4:  # the sign is known beside an error that is larger than it was, and not by much
        assert form["criticality"] == "supercritical"


def test_balancing_beside_long_cycles_does_not_overflow():
    """Derivatives of a cycle of 64 points are 1e170; a RuntimeWarning is a failure."""
    local = SimpleNamespace(problem=SimpleNamespace(is_timeless=False))
    units = _balancing_units(local, np.array([[1e200, 1e170, 1.0], [1e180, 1e200, 1.0]]))
    assert np.isfinite(units).all()
