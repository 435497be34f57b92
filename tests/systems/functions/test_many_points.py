"""Functions at many points at once: with parameters for each or one for all, as formulas take them."""

import numpy as np
import pytest

import contin
from contin.lowering import compile_system

FORMULAS = {
    "name": "turn", "states": {"x": 1.0, "y": 0.0}, "parameters": {"a": 1.0, "w": 1.0},
    "equations": {"x": "a*x - w*y - x*(x^2 + y^2)", "y": "w*x + a*y - y*(x^2 + y^2)"},
}  # fmt: skip


def turn(u, p):
    x, y = u
    r2 = x * x + y * y
    return np.array([p["a"] * x - p["w"] * y - x * r2, p["w"] * x + p["a"] * y - y * r2])


FUNCTION = contin.FunctionProblem(turn, [1.0, 0.0], {"a": 1.0, "w": 1.0}, states=["x", "y"])


@pytest.mark.parametrize("system", [FUNCTION.system(), FUNCTION.in_kernels], ids=["python", "in kernels"])
@pytest.mark.parametrize("each", [False, True])
def test_values_at_many_points_take_one_row_of_parameters_or_one_for_each(system, each):
    generator = np.random.default_rng(4)
    u, p = generator.normal(size=(5, 2)), generator.normal(size=(5, 2))
    others = p if each else p[0]
    formulas = compile_system(contin.load(FORMULAS))
    np.testing.assert_allclose(system.values(u, others), formulas.values(u, others), rtol=1e-14, atol=1e-14)
    one = system.values(u[:1], p[:1])
    np.testing.assert_allclose(one[0], system.value(u[0], p[0]), rtol=1e-15)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_orbits_of_a_function_are_compared_like_those_of_formulas(method):
    """A circle and one that is wider by 1e-4 and begins 1e-4 elsewhere: without the shift the width is left."""
    t, apart = np.linspace(0.0, 2.0 * np.pi, 41), []
    u = np.column_stack([np.cos(t), np.sin(t)])
    for model in (FUNCTION, contin.load(FORMULAS)):
        seed = contin.periodic_orbit(model, u, times=t, method=method, intervals=4).seed("a")
        other = seed.z.copy()
        states = 4 * 4 * 2 + 2 if method == "collocation" else 4 * 2
        x, y = seed.z[:states:2], seed.z[1:states:2]
        other[:states:2], other[1:states:2] = x + 1e-4 * (x - y), y + 1e-4 * (y + x)
        apart.append(seed.problem.apart_at_shared_places(seed.z, other))
    np.testing.assert_allclose(apart[0], apart[1], atol=1e-9)
    assert np.abs(apart[0]).max() < 1.1e-4
