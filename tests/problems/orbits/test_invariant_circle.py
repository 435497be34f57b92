"""A saddle-node on an invariant circle: angle' = a - cos(angle) on r = 1, period 2 pi/sqrt(a^2 - 1), ends at a = 1."""

import numpy as np
import pytest

import contin


def test_the_label_stands_where_its_error_says():
    model = contin.Model(
        "snic", states={"x": {"value": 1, "scale": 1}, "y": {"value": 0, "scale": 1}}, parameters={"a": 1.2},
        definitions={"r": "sqrt(x^2 + y^2)"},
        equations={"x": "x*(1 - r^2) - y*(a - x/r)", "y": "y*(1 - r^2) + x*(a - x/r)"},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(model, {"x": 1, "y": 0.01}), "a", (0.5, 2))
    columns = family.columns
    inner = columns["a"] > 1.001
    np.testing.assert_allclose(columns["period"][inner], 2 * np.pi / np.sqrt(columns["a"][inner] ** 2 - 1), rtol=1e-6)
    (point,) = family.points
    assert point.type == "HOM"
    assert point.normal_form["kind"] == "saddle-node"
    assert abs(point.values["a"] - 1.0) <= point.error
    assert point.error < 1e-9
    assert point.normal_form["at"]["a"] == pytest.approx(point.values["a"], abs=point.error)
