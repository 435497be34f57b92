"""Ends of families of orbits against systems where they are known."""

from math import pi

import numpy as np
import pytest

from contin import api
from contin.model.model import Model


def test_family_that_ends_on_a_fold_of_equilibria():
    """theta' = a - cos theta on the unit circle: period 2 pi / sqrt(a^2 - 1), saddle-node at a = 1, x = 1, y = 0."""
    model = Model(
        "circle", states={"x": 0, "y": 1}, parameters={"a": 2}, definitions={"s": "x^2 + y^2", "turn": "a - x"},
        equations={"x": "(1 - s)*x - turn*y", "y": "turn*x + (1 - s)*y"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"x": 0.0, "y": 1.0}), "a", (0.5, 3.0))
    a = family.columns["a"]
    np.testing.assert_allclose(family.columns["period"], 2.0 * pi / np.sqrt(a**2 - 1.0), rtol=1e-6)
    end = family.ends[0]
    assert end.reason == "homoclinic"
    assert end.data["at"]["a"] == pytest.approx(1.0, abs=1e-9)
    assert end.data["saddle"] == pytest.approx({"x": 1.0, "y": 0.0}, abs=1e-6)
    assert [p.type for p in family.points] == ["HOM"]


def test_rotations_end_at_one_saddle_whatever_sheet_of_the_angle_it_is_on():
    """Damped pendulum with torque: the rotations end at I = 4 g / pi + O(g^2) (Melnikov)."""
    model = Model(
        "pendulum", states={"phi": {"value": 0, "period": "2*pi"}, "w": 3}, parameters={"I": 0.5, "g": 0.1},
        equations={"phi": "w", "w": "I - sin(phi) - g*w"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"phi": 0.0, "w": 4.0}), "I", (0.0, 0.6))
    end = family.ends[0]
    assert end.reason == "homoclinic"
    assert end.data["at"]["I"] == pytest.approx(4.0 * 0.1 / pi, rel=0.01)
    assert end.data["saddle"]["w"] == pytest.approx(0.0, abs=1e-9)
