"""Jacobians at many points: the digits of one at a time, from every kind of system."""

from __future__ import annotations

import numpy as np
import pytest

from contin.lowering.system import CompiledSystem
from contin.model.model import Model
from contin.systems.iterate import iterate


def model(kind: str, parameters: dict[str, float]) -> Model:
    """Two states; without parameters where none are given."""
    a = "a" if parameters else "0.7"
    equations = {"x": f"{a}*x - x*y^2 + 0.3", "y": f"sin(x) - {a}*y"}
    return Model("two", kind=kind, states={"x": 0, "y": 0}, parameters=parameters, equations=equations)


@pytest.mark.parametrize("parameters", [{}, {"a": 0.7, "b": 2.0}])
@pytest.mark.parametrize("times", [0, 3])
def test_jacobians_at_many_points_are_those_at_each(parameters, times):
    system = CompiledSystem(model("map" if times else "flow", parameters))
    system = iterate(system, times) if times else system
    generator = np.random.default_rng(1)
    u, p = generator.normal(size=(7, 2)), generator.normal(size=(7, len(parameters)))
    values, matrices = system.jacobians(u[:, ::-1], p)  # of any layout
    for k in range(7):
        value, matrix = system.jacobian(u[k, ::-1], p[k])
        np.testing.assert_array_equal(values[k], value)
        np.testing.assert_array_equal(matrices[k], matrix)
        np.testing.assert_array_equal(system.jacobians(u[k, None, ::-1], p[k, None])[1][0], matrix)


def test_no_points_have_no_jacobians():
    values, matrices = CompiledSystem(model("flow", {"a": 0.7})).jacobians(np.empty((0, 2)), np.empty((0, 1)))
    assert values.shape == (0, 2)
    assert matrices.shape == (0, 2, 3)
