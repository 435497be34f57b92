"""What solutions of boundary-value problems cost: linearisations are counted, on Bratu's problem u'' + p exp(u) = 0.

Its lower solution is u = 2 log(cosh(s) / cosh(s (1 - 2 t))), p = 8 (s / cosh s)^2, s tanh(s) < 1.
"""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.bvp import special_points
from contin.bvp.from_guess import boundary_guess
from contin.bvp.on_mesh import OnMesh
from contin.model.model import Model


def bratu():
    return Model(
        "bratu", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"u": 0, "v": 0}, parameters={"p": 0.5},
        equations={"u": "v", "v": "-p*exp(u)"}, conditions=["u(start) = 0", "u(end) = 0"],
    )  # fmt: skip


@pytest.fixture(scope="module")
def branch():
    return contin.continuation(boundary_guess(bratu(), None, None, ()), "p", (0.5, 2.0))


def test_a_solution_next_to_a_known_one_takes_two_linearisations(branch, monkeypatch):
    problem, z = branch.problem, branch.z[branch.start_row]
    z = z[np.isfinite(z)]
    scale = problem.initial_scale(z, (0.5, 2.0))
    seen = []
    linearise = special_points.linearise

    def counted(*arguments):
        seen.append(arguments[1])
        return linearise(*arguments)

    monkeypatch.setattr(special_points, "linearise", counted)
    s = 0.3
    found = problem.at_parameter(z, 8.0 * (s / np.cosh(s)) ** 2, scale)
    profile = problem.profile(found)
    exact = 2.0 * np.log(np.cosh(s) / np.cosh(s * (1.0 - 2.0 * profile.times)))
    assert np.abs(profile.u[:, 0] - exact).max() < 1e-9
    assert len(seen) <= 3  # from farther away
    seen.clear()
    beside = found + 1e-6 * scale * (np.arange(found.size) < profile.u.size)  # not of the mesh
    again = problem.at_parameter(beside, float(found[-1]), scale)
    assert np.abs((again - found) / scale).max() < 1e-12
    assert len(seen) <= 2


def test_a_residual_alone_has_the_bits_of_that_with_derivatives(branch):
    z = branch.z[-1]
    z = z[np.isfinite(z)]
    problem = branch.problem
    h = problem.profile(z).h
    one, other = OnMesh(problem, h), OnMesh(problem, h)
    x = one.unknowns(z) + 0.01
    assert np.array_equal(one.residual(x), other.at(x).residual)
    assert one._known == ()  # nothing was linearised
    assert np.all(np.isnan(one.residual(np.full(x.size, np.nan))))
