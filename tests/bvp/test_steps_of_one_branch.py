"""Whether the solutions inside a step lie on the cubic of its two rows: of one branch they do, of two they do not."""

import numpy as np
import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.continuation.gone_over_on_meshes import on_one_curve

BRATU = {
    "name": "bratu", "kind": "bvp", "states": {"u": 0, "v": 0}, "parameters": {"lam": 0},
    "equations": {"u": "v", "v": "-lam*exp(u)"}, "conditions": ["u(start) = 0", "u(end) = 0"],
}  # fmt: skip
BOUNDS = (0.0, 4.0)


@pytest.fixture(scope="module")
def branch():
    guess = boundary_guess(contin.load(BRATU), None, None, ())
    return contin.continuation(guess, "lam", BOUNDS, values={"lam": [1.0, 1.6, 2.2]})


@pytest.mark.parametrize(("near", "far", "one"), [(0, 1, True), (1, 2, True), (0, 4, False), (1, 3, False)])
def test_rows_of_the_lower_and_of_the_upper_branch_are_told_apart(branch, near, far, one):
    """Of lam = 1, 1.6, 2.2 below the fold at 3.5138 and 2.2, 1.6, 1 beyond it."""
    points = [point for point in branch.points if point.type == "UZ"]
    rows = [points[near].index, points[far].index]
    z = branch.z[rows]
    sizes = np.abs(branch.problem.at_shared_places(z[1], z[1])).max(axis=0)
    assert on_one_curve(branch.problem, z, branch.tangents[rows], sizes, BOUNDS) is one
