"""Rows beside the narrow top of a pitchfork are solutions to the corrector's tolerance, or steps are shorter.

Beside a singular point corrections fall like a geometric series (two thirds of the last one at a triple root), which is
no sign that they are as small as rounding lets them be: rows were 7e-6 off, where no solution is but zero.
"""

import numpy as np
import pytest
import scipy.sparse
from scipy.optimize import brentq

import contin
from tests.problems.follow import model

SHAPES = {"atan": np.arctan, "tanh": np.tanh}


@pytest.mark.parametrize("beyond", [1.01, 1.3])
@pytest.mark.parametrize("steepness", [300.0, 3000.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_every_row_is_a_solution_or_next_to_one(shape, steepness, beyond):
    f = SHAPES[shape]
    needle = model({"x": f"{shape}({steepness}*x) - a*x"}, {"x": 1.0}, {"a": float(f(steepness))})
    branch = contin.continuation(contin.equilibrium(needle), "a", (0.2, beyond * steepness))
    assert branch["BP1"] if branch.points else branch.notes
    for a, x in zip(branch.columns["a"], branch.columns["x"], strict=True):
        solutions = [0.0]
        if f(steepness * 1e-12) > a * 1e-12:  # below the top there are two others
            root = brentq(lambda y, a=a: f(steepness * y) - a * y, 1e-12, 100.0, xtol=1e-14)
            solutions += [root, -root]
        assert min(abs(x - one) for one in solutions) < 2e-9


@pytest.mark.parametrize("beyond", [1.0001, 1.3])
@pytest.mark.parametrize("shape", SHAPES)
def test_rows_of_large_systems_too(shape, beyond):
    """The needle as the first of ten states, the others linear: rows were up to 1e-4 off."""
    f, slope = SHAPES[shape], {"atan": lambda y: 1.0 / (1.0 + y * y), "tanh": lambda y: 1.0 - np.tanh(y) ** 2}[shape]
    k, n = 3000.0, 10

    def residual(u, p):
        return np.append(f(k * u[0]) - p["a"] * u[0], 0.1 * u[:-1] - u[1:])

    def jacobian(u, p):
        first = k * slope(k * u[0]) - p["a"]
        return scipy.sparse.diags([np.append(first, -np.ones(n - 1)), np.full(n - 1, 0.1)], [0, -1], format="csc")

    needle = contin.FunctionProblem(residual, 0.1 ** np.arange(n), {"a": float(f(k))}, jacobian)
    branch = contin.continuation(contin.equilibrium(needle), "a", (0.2, beyond * k))
    sizes = branch.problem.initial_scale(branch.z[0], (0.2, beyond * k))[[0, -1]]  # of x and of a
    for a, x in zip(branch.columns["a"], branch.z[:, 0], strict=True):  # on one of two curves, x = 0 and a = f(k x)/x
        if abs(x) > 1e-9 * sizes[0]:
            off = abs(f(k * x) / x - a)
            aside = off * x * x / abs(k * x * slope(k * x) - f(k * x))
            assert min(off / sizes[1], aside / sizes[0]) < 5e-9
