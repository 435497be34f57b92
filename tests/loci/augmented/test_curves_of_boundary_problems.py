"""Curves of folds, branch points, cusps and extrema of boundary-value problems against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import mathieu_a

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model

COARSE = {"intervals": 3, "points": 3, "max_step": 0.3}  # constants and parabolas are exact on any mesh
FOLD = 3.513830719125162  # of Bratu's problem: 8 c^2 / cosh^2 c with c tanh c = 1


def bvp(states, equations, conditions, parameters, **more):
    return Model(
        "m", kind="bvp", states=dict.fromkeys(states, 0), equations=equations, conditions=conditions,
        parameters=parameters, **more,
    )  # fmt: skip


def test_the_folds_of_bratus_problem_scaled():
    """u'' = -lam k^2 exp(k u): k u solves Bratu's problem with lam k^3."""
    model = bvp("uv", {"u": "v", "v": "-lam*k^2*exp(k*u)"}, ["u(start) = 0", "u(end) = 0"], {"lam": 1.0, "k": 1})
    line = contin.continuation(boundary_guess(model), "lam", (0.5, 4), direction="up")
    point = line["LP1"]
    found = contin.continuation(point.locus(("lam", "k")), ("lam", "k"), {"lam": (2, 6), "k": (0.8, 1.3)})
    assert (found.kind, found.locus, found.parameters) == ("locus", "LP", ("lam", "k"))
    assert "unstable" not in found.columns
    assert np.allclose(found.columns["lam"] * found.columns["k"] ** 3, FOLD, rtol=1e-9)
    assert len(found) > 5
    assert [end.reason for end in found.ends] == ["bound", "bound"]


def test_branch_points_that_a_symmetry_forces():
    """u'' = -lam k sin u: the straight rod buckles at lam k = pi^2."""
    model = bvp("uv", {"u": "v", "v": "-lam*k*sin(u)"}, ["u(start) = 0", "u(end) = 0"], {"lam": 5, "k": 1})
    line = contin.continuation(boundary_guess(model), "lam", (5, 20))
    found = contin.continuation(line["BP1"].locus(("lam", "k")), ("lam", "k"), {"lam": (6, 14), "k": (0.2, 3)})
    assert found.locus == "BP"
    assert np.allclose(found.columns["lam"] * found.columns["k"], np.pi**2, rtol=1e-9)
    assert np.abs(found.columns["unfolding"]).max() < 1e-10


def constant(condition, parameters):
    """u' = 0 with one condition on the constant: an algebraic equation that is solved as a boundary-value problem."""
    return bvp("u", {"u": "0"}, [condition], parameters, starts={"far": {"u": 1.5}})


@pytest.mark.seldom
def test_cusps_and_their_curve_in_three_parameters():
    """u^4 + c u^2 + b u + a: cusps at a = -3 u^4, b = 8 u^3, c = -6 u^2."""
    names = ("a", "b", "c")
    model = constant("a + b*u(start) + c*u(end)^2 + u(start)^4 = 0", {"a": -1, "b": -1, "c": -1})
    line = contin.continuation(boundary_guess(model, "far"), "a", (-1.5, 2), settings=COARSE)
    wide = dict.fromkeys(names, (-1.5, 1.5))
    folds = contin.continuation(line["LP1"].locus(("a", "b")), ("a", "b"), {k: wide[k] for k in "ab"}, settings=COARSE)
    cusps = sorted(p.values["b"] for p in folds.points)
    assert {p.type for p in folds.points} == {"CP"}
    assert cusps == pytest.approx([-8 / 6**1.5, 8 / 6**1.5], abs=1e-9)
    found = contin.continuation(folds["CP1"].locus(names), names, wide | {"c": (-1.3, -0.8)}, settings=COARSE)
    u = found.columns["u.start"]
    for name, exact in {"a": -3 * u**4, "b": 8 * u**3, "c": -6 * u**2}.items():
        assert np.allclose(found.columns[name], exact, atol=1e-8)
    assert np.ptp(u) > 0.09


def test_generic_branch_points_in_three_parameters():
    """(u - s)(p - u - s) + r - s^2 = 0: branches in p cross at p = 2 s, u = s, r = s^2."""
    names = ("p", "r", "s")
    model = constant("(u(start) - s)*(p - u(end) - s) + r - s^2 = 0", {"p": 0, "r": 0.25, "s": 0.5})
    line = contin.continuation(boundary_guess(model, {"u": 0.5}), "p", (-2, 3), settings=COARSE)
    box = {"p": (-4, 4), "r": (-4, 4), "s": (-1, 1)}
    found = contin.continuation(line["BP1"].locus(names), names, box, settings=COARSE)
    s = found.columns["s"]
    assert np.allclose(found.columns["p"], 2 * s, atol=1e-8)
    assert np.allclose(found.columns["r"], s**2, atol=1e-8)
    assert np.ptp(s) > 1.9


def test_extrema_of_a_functional():
    """u'' = -2 m with u = 0 at both ends, m = 1 - (a - b/2)^2 - (b - 1)^2: largest at a = 1/2, b = 1."""
    model = bvp(
        "uv", {"u": "v", "v": "-2*(1 - (a - b/2)^2 - (b - 1)^2)"},
        ["u(start) = 0", "u(end) = 0"],
        {"a": 0.3, "b": 0.8}, observables={"mass": "integral(u)"},
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model), "a", (0, 1), extrema=["mass"], settings=COARSE)
    found = contin.continuation(
        line["EX1"].locus(("a", "b")), ("a", "b"), {"a": (0, 1), "b": (0.7, 1.2)}, extrema=["mass"], settings=COARSE
    )
    assert np.allclose(found.columns["a"], 0.5 * found.columns["b"], atol=1e-8)
    best = found["EX1"]
    assert best.values["b"] == pytest.approx(1.0, abs=1e-8)
    assert best.values["mass"] == pytest.approx(1 / 6, rel=1e-9)


def test_characteristic_values_of_mathieus_equation():
    """u'' = -(a - 2 q cos 2x) u with u' = 0 at 0 and pi: a_1(q), on meshes that serve the eigenfunction.

    The solution is u = 0 all along: on the mesh that it asks for a was 1e-5 off at q = 10, and the error stated as 0.
    """
    model = Model(
        "mathieu", kind="bvp", time={"name": "x", "from": 0, "to": "pi"}, states={"u": 0, "v": 0},
        parameters={"a": 0.0, "q": 1.0}, equations={"u": "v", "v": "-(a - 2*q*cos(2*x))*u"},
        conditions=["v(start) = 0", "v(end) = 0"],
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model), "a", (0.0, 3.0), direction="up")
    assert abs(line["BP1"].values["a"] - mathieu_a(1, 1.0)) <= line["BP1"].error
    box, marked = {"a": (-30.0, 20.0), "q": (0.0, 12.0)}, [5.0, 10.0]
    curve = contin.continuation(line["BP1"].locus(("a", "q")), ("a", "q"), box, values={"q": marked})
    points = sorted((p for p in curve.points if p.type == "UZ"), key=lambda p: p.values["q"])
    assert [p.values["q"] for p in points] == marked
    for point in points:
        assert abs(point.values["a"] - mathieu_a(1, point.values["q"])) <= point.error < 1e-7
