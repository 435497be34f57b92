"""Rows beside the narrow top of a pitchfork are solutions to the corrector's tolerance, or steps are shorter.

Beside a singular point corrections fall like a geometric series (two thirds of the last one at a triple root), which is
no sign that they are as small as rounding lets them be: rows were 7e-6 off, where no solution is but zero.
"""

import numpy as np
import pytest
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
