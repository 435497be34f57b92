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


def test_a_solution_on_a_fine_mesh_is_not_taken_for_a_trivial_one():
    """The null function's mesh (some 250 intervals) was kept, as on it the estimated error of any solution is small."""
    model = Model(
        "slow", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"v": 0, "h": 0.5, "s": 0.24},
        parameters={"T": -1e-3},
        equations={"v": "T*(h - (v^3 - v + 1)/2 - s*v/2)", "h": "-0.015*T*(2*h + 2.6*v)", "s": "-0.008475*T*s"},
        conditions=["v(start) = 0", "h(start) = 0.5", "s(start) = 0.24"],
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model, None, None, ()), "T", (-3.0, 0.0), direction="down")
    assert [end.reason for end in line.ends] == ["bound", "start"]
    assert line.columns["s.end"] == pytest.approx(0.24 * np.exp(-0.008475 * line.columns["T"]), abs=1e-10)
    beyond = line.z[line.columns["T"] < -1.0]
    assert max(line.problem.profile(row).intervals for row in beyond) <= 20


def test_a_complex_fold_is_seen_to_be_no_point_where_two_modes_vanish_with_their_slopes(monkeypatch):
    """Bratu's problem for complex functions (Henderson and Keller 1990): its fold has a kernel of two dimensions."""
    model = Model(
        "complex", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states=dict.fromkeys(("u", "v", "x", "y"), 0),
        parameters={"p": 0}, conditions=["u(start) = 0", "v(start) = 0", "u(end) = 0", "v(end) = 0"],
        equations={"u": "x", "v": "y", "x": "-p*exp(u)*cos(v)", "y": "-p*exp(u)*sin(v)"},
    )  # fmt: skip
    seen = {"verify": 0, "residual": 0}
    verify, residual = special_points.verify, OnMesh.residual

    def counted(*arguments):
        seen["verify"] += 1
        return verify(*arguments)

    def counted_residual(*arguments):
        seen["residual"] += 1
        return residual(*arguments)

    monkeypatch.setattr(special_points, "verify", counted)
    monkeypatch.setattr(OnMesh, "residual", counted_residual)
    line = contin.continuation(boundary_guess(model, None, None, ()), "p", (0.0, 5.0))
    (point,) = line.points
    s = 1.1996786402577338  # s tanh(s) = 1
    assert abs(point.values["p"] - 8.0 * (s / np.cosh(s)) ** 2) <= point.error + 1e-13 < 1e-9
    assert point.normal_form["kernel"] == 2
    assert seen["verify"] == 2  # once where it is found, and once for all that lies there; there were 3
    assert seen["residual"] < 500  # there were 1,400
