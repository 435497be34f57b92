"""What solutions of boundary-value problems cost: linearisations are counted, on Bratu's problem u'' + p exp(u) = 0.

Its lower solution is u = 2 log(cosh(s) / cosh(s (1 - 2 t))), p = 8 (s / cosh s)^2, s tanh(s) < 1.
"""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.bvp import condensed, solutions_at_parameter, special_points
from contin.bvp.condensed import linearise, met_to_rounding, residual_at
from contin.bvp.defects import resolving
from contin.bvp.from_guess import boundary_guess
from contin.bvp.on_mesh import OnMesh
from contin.continuation.way_back import followed
from contin.model.model import Model
from contin.problems.orbits.mesh.layout import Profile, node_times


def bratu():
    return Model(
        "bratu", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"u": 0, "v": 0}, parameters={"p": 0.5},
        equations={"u": "v", "v": "-p*exp(u)"}, conditions=["u(start) = 0", "u(end) = 0"],
    )  # fmt: skip


@pytest.fixture(scope="module")
def branch():
    return contin.continuation(boundary_guess(bratu(), None, None, ()), "p", (0.5, 2.0))


def test_a_solution_next_to_a_known_one_takes_one_linearisation(branch, monkeypatch):
    problem, z = branch.problem, branch.z[branch.start_row]
    z = z[np.isfinite(z)]
    scale = problem.initial_scale(z, (0.5, 2.0))
    seen = []
    linearise = solutions_at_parameter.linearise

    def counted(*arguments):
        seen.append(arguments[1])
        return linearise(*arguments)

    monkeypatch.setattr(solutions_at_parameter, "linearise", counted)
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
    assert len(seen) == 1  # there were two


def test_solutions_that_are_followed_take_one_linearisation_each(branch, monkeypatch):
    """From guesses by the two before, along the lower branch of Bratu's problem, up to half its way to the fold."""
    problem, z = branch.problem, branch.z[branch.start_row]
    z = z[np.isfinite(z)]
    scale, seen, linearise = problem.initial_scale(z, (0.5, 2.0)), [], solutions_at_parameter.linearise

    def counted(*arguments):
        seen.append(arguments[1])
        return linearise(*arguments)

    places = [float(8.0 * (s / np.cosh(s)) ** 2) for s in np.linspace(0.26, 0.5, 13)]
    start = problem.at_parameter(z, places[0], scale)
    monkeypatch.setattr(solutions_at_parameter, "linearise", counted)
    rows, _ = followed(problem, start, places[1:9], scale)
    assert len(rows) == 1
    assert len(seen) <= 10  # there were 16
    profile = problem.profile(rows[0])
    exact = 2.0 * np.log(np.cosh(s := 0.42) / np.cosh(s * (1.0 - 2.0 * profile.times)))
    assert np.abs(profile.u[:, 0] - exact).max() < 1e-7  # of this mesh


def test_a_solution_is_met_to_rounding_and_what_is_beside_it_not(branch):
    problem, z = branch.problem, branch.z[branch.start_row]
    z = z[np.isfinite(z)]
    scale = problem.initial_scale(z, (0.5, 2.0))
    found = problem.at_parameter(z, float(z[-1]) + 1e-3, scale)
    place = np.arange(found.size)
    beside = found + 1e-11 * scale * np.cos(place) * (place < problem.profile(found).u.size)
    here = linearise(problem, found, np.eye(found.size)[-1], scale)
    assert met_to_rounding(here, residual_at(problem, found), found)
    assert not met_to_rounding(here, residual_at(problem, beside), beside)


def test_terms_of_the_equations_are_those_of_their_matrix(branch, monkeypatch):
    """A residual as large as |F_u| |u| + |F_p p| is rounding where rounding is 1, and one 1.5 times as large is not."""
    z = branch.z[-1]
    z = z[np.isfinite(z)]
    mesh = OnMesh(branch.problem, branch.problem.profile(z).h)
    at = mesh.at(mesh.unknowns(z))
    terms = at.linear.magnitude(np.abs(z[: mesh.n])) + np.abs(at.slope * z[-1])
    here = linearise(branch.problem, z, np.eye(z.size)[-1], branch.problem.initial_scale(z, (0.5, 2.0)))
    monkeypatch.setattr(condensed, "ROUNDING", 1.0 + 1e-14)
    assert met_to_rounding(here, terms, z)
    assert not met_to_rounding(here, 1.5 * terms, z)


def test_only_intervals_where_a_solution_is_not_smooth_are_looked_at_again(monkeypatch):
    """u' = |t - 1/3|^(1/2): of 60 intervals those about 1/3 are halved, and their parts."""
    model = Model(
        "corner", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"u": 0}, parameters={"p": 1},
        equations={"u": "p*sqrt(abs(t - 1/3))"}, conditions=["u(start) = 0"],
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model, None, None, ()), "p", (0.5, 2.0))
    problem = line.problem
    h = np.full(60, 1.0 / 60.0)
    times = node_times(h, problem.points)
    exact = (2.0 / 3.0) * ((1.0 / 3.0) ** 1.5 + np.sign(times - 1.0 / 3.0) * np.abs(times - 1.0 / 3.0) ** 1.5)
    profile = Profile(problem.points, exact[:, None], 1.0, h, 1.0)
    seen, jacobians = [], type(problem.two.system).jacobians

    def counted(system, u, p):
        seen.append(len(u))
        return jacobians(system, u, p)

    monkeypatch.setattr(type(problem.two.system), "jacobians", counted)
    finer = resolving(problem, profile, h, np.ones(1), 1e-9)
    assert 60 < len(finer) < 120
    inner = 3 * problem.points + 2  # places in an interval
    assert seen[0] == 60 * inner
    assert max(seen[1:]) <= 20 * inner  # it was all of them, 120 and more


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
