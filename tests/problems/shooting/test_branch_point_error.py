"""The stated error of a branch point of orbits by shooting covers its distance from the closed form."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


@pytest.mark.parametrize("radius", [0.8, 0.55])
def test_branch_points_of_two_circles_lie_where_they_cross_to_their_error(radius):
    """r' = -r (r - p)(r - q): a transcritical branch point at p = q."""
    growth = "-(r - p)*(r - q)"
    model = Model(
        "crossing", states={"x": 1.2, "y": 0}, parameters={"p": 1.2, "q": radius}, definitions={"r": "sqrt(x^2 + y^2)"},
        equations={"x": f"({growth})*x - y", "y": f"x + ({growth})*y"},
    )  # fmt: skip
    angle = np.linspace(0, 2 * np.pi, 101)
    circle = 1.2 * np.column_stack([np.cos(angle), np.sin(angle)])
    orbit = contin.periodic_orbit(model, circle, period=2 * np.pi, method="shooting")
    point = contin.continuation(orbit, "p", (0.3, 2.0))["BPC1"]
    assert abs(point.values["p"] - radius) <= point.error < 1e-6
    assert point.normal_form["kind"] == "transcritical"
