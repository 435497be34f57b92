"""Branch points of boundary-value problems at which two modes vanish at once, and all branches through them."""

import math

import numpy as np
import pytest
from scipy.special import ellipk

import contin

ENDS = [f"{name}({end}) = 0" for name in "xy" for end in ("start", "end")]


def pair(angle, force):
    """x'' = -F(x, y), seen in coordinates turned by an angle: F = (f(u, w), f(w, u)) in u, w."""
    c, s = math.cos(angle), math.sin(angle)
    return contin.load({
        "name": "pair", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": dict.fromkeys("xvyz", 0),
        "parameters": {"p": {"value": 8.0, "range": [8, 14]}},
        "definitions": {
            "u": f"{c!r}*x + {s!r}*y", "w": f"{c!r}*y - {s!r}*x",
            "fu": force, "fw": force.replace("u", "#").replace("w", "u").replace("#", "w"),
        },
        "equations": {"x": "v", "v": f"-({c!r}*fu - {s!r}*fw)", "y": "z", "z": f"-({s!r}*fu + {c!r}*fw)"},
        "conditions": ENDS,
    })  # fmt: skip


def parameter(amplitude):
    """p of u'' + p (u - u^3) = 0, u(0) = u(1) = 0, u >= 0: by the quarter of a period of the pendulum-like motion."""
    a = amplitude**2
    return 4.0 * ellipk(a / (2.0 - a)) ** 2 / (1.0 - 0.5 * a)


def at_middle(branch, row, angle):
    """u and w at t = 1/2, where they are largest."""
    x, _, y, _ = branch.problem.profile(branch.z[row]).at(np.array([0.5]))[0]
    return np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x


def followed(model, steps):
    line = contin.continuation(contin.boundary_problem(model), "p", (8, 12))
    (point,) = line.points
    assert abs(point.values["p"] - np.pi**2) <= point.error < 1e-7
    seeds = point.switch()
    return point, [contin.continuation(seed, "p", (8, 14), settings={"steps": steps}) for seed in seeds]


@pytest.mark.parametrize(("angle", "coupling"), [(0.0, 0.0), (0.3, 0.5)])
@pytest.mark.seldom
def test_four_branches_leave_where_two_pitchforks_coincide(angle, coupling):
    """u'' + p (u - u^3 - c u w^2) = 0 and the same for w: u alone, w alone, u = w, u = -w; an elliptic integral."""
    point, branches = followed(pair(angle, f"p*(u - u^3 - {coupling}*u*w^2)"), 6)
    assert {k: point.normal_form[k] for k in ("kind", "kernel", "scaling", "branches")} == {
        "kind": "multiple", "kernel": 2, "scaling": "cubic", "branches": 5,
    }  # fmt: skip
    ways = set()
    for branch in branches:
        assert [p.type for p in branch.points] == []
        for row in (0, -1):
            u, w = at_middle(branch, row, angle)
            size, factor = max(abs(u), abs(w)), 1.0 + coupling * (min(abs(u), abs(w)) > 1e-3)
            assert branch.columns["p"][row] == pytest.approx(parameter(size * np.sqrt(factor)), rel=1e-6)
        ways.add((abs(u) > 1e-3, abs(w) > 1e-3, u * w > 1e-6))
        assert np.hypot(u, w) > 0.01
    assert ways == {(True, False, False), (False, True, False), (True, True, True), (True, True, False)}


def test_three_branches_leave_where_two_transcritical_points_coincide():
    """u'' + p (exp(u) - 1) = 0 twice: each alone, and both together."""
    point, branches = followed(pair(0.0, "p*(exp(u) - 1)"), 4)
    assert (point.normal_form["scaling"], point.normal_form["branches"]) == ("quadratic", 4)
    ways = set()
    for branch in branches:
        x, y = (branch.columns[f"{k}.norm"] for k in "xy")
        moved = {k: bool(v[0] > 1e-3) for k, v in (("x", x), ("y", y))}
        ways.add((moved["x"], moved["y"]))
        if moved["x"] and moved["y"]:
            np.testing.assert_allclose(x, y, rtol=1e-8, atol=1e-12)
        size = max(x[0], y[0])
        assert size > 1e-2
    assert ways == {(True, False), (False, True), (True, True)}


def test_two_modes_that_vanish_next_to_each_other_are_two_labels_and_no_multiple_one():
    """u'' + p (u - u^3) = 0 beside w'' + q p (w - w^3) = 0: pi^2 and pi^2/q, a part of 1e-9 apart."""
    q = 1.0 + 1e-9
    equations = {"x": "v", "v": "-p*(x - x^3)", "y": "z", "z": f"-p*{q!r}*(y - y^3)"}
    model = contin.load({
        "name": "near", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": dict.fromkeys("xvyz", 0),
        "parameters": {"p": {"value": 9.0, "range": [9, 11]}}, "equations": equations, "conditions": ENDS,
    })  # fmt: skip
    points = contin.continuation(contin.boundary_problem(model), "p", (9, 11)).points
    for point, exact in zip(points, (np.pi**2 / q, np.pi**2), strict=True):
        assert abs(point.values["p"] - exact) <= point.error < 1e-11
        assert point.normal_form["kind"] != "multiple"


def test_two_modes_of_different_accuracy_that_vanish_together_are_one_multiple_point():
    """A hinged beam on a foundation, w'''' + P w'' + k w + w^3 = 0: P = 5 pi^2 for one half-wave and for two at
    k = 4 pi^4. With amplitudes a, b the reduced equations are a (pi^2 m - a^2 - 2 b^2), b (4 pi^2 m - b^2 - 2 a^2):
    each mode alone, and none together. On a mesh the second mode's place is off by more than the first one's error."""
    model = contin.load({
        "name": "beam", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": dict.fromkeys("wxyz", 0),
        "parameters": {"P": {"value": 40.0, "range": [40, 60]}},
        "equations": {"w": "x", "x": "y", "y": "z", "z": "-P*y - 4*pi^4*w - w^3"},
        "conditions": [f"{name}({end}) = 0" for name in "wy" for end in ("start", "end")],
    })  # fmt: skip
    (point,) = contin.continuation(contin.boundary_problem(model), "P", (40, 60)).points
    assert abs(point.values["P"] - 5.0 * np.pi**2) <= point.error < 1e-8
    assert {k: point.normal_form[k] for k in ("kind", "kernel", "scaling", "branches")} == {
        "kind": "multiple", "kernel": 2, "scaling": "cubic", "branches": 3,
    }  # fmt: skip
