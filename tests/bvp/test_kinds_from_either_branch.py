"""A branch point is of one kind, seen from either branch that crosses there: rounding decides nothing."""

import math

import pytest

import contin
from contin import api


@pytest.mark.parametrize("e", [0.05, 0.01])
def test_a_pitchfork_is_one_from_its_side_branch_as_well(e):
    """u'' + (pi^2 + g) u - u^3 = 0, u(0) = u(1) = 0, g = 10 p (p - e) (p + e): pitchforks at the zeros of g."""
    model = contin.Model(
        "waves", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"u": 0.0, "v": 0.0},
        parameters={"p": {"value": -0.53, "range": [-1, 1]}}, conditions=["u(start) = 0", "u(end) = 0"],
        equations={"u": "v", "v": f"-(pi^2 + 10*p*(p - {e})*(p + {e}))*u + u^3"},
    )  # fmt: skip
    line = api.continuation(api.boundary_problem(model), "p", (-0.53, 0.6))
    assert [point.type for point in line.points] == ["BP"] * 3
    side = line["BP1"].switch()
    branch = api.continuation(side[0] if isinstance(side, list) else side, "p", (-0.53, 0.6))
    crossed = [*line.points, *branch.points]
    assert len(crossed) > 3
    for point in crossed:
        form = point.normal_form
        assert form["kind"] == "pitchfork"
        assert abs(form["b20"]) <= 3 * form["errors"]["b20"]


def test_functions_that_are_zero_do_not_hide_a_pitchfork():
    """A rod with stiffnesses 1 and 1.3, clamped at both ends, under a thrust T buckles at 4 pi^2 and 5.2 pi^2.

    It bends in one plane there: of the null vector nothing is left in the other but remnants of Newton's method.
    """
    d3 = {"x": "2*(q1*q3 + q2*q4)", "y": "2*(q2*q3 - q1*q4)", "z": "q3^2 + q4^2 - q1^2 - q2^2"}
    turn = {
        "q1": "(q4*u1 - q3*u2 + q2*u3)/2 + mu*q1", "q2": "(q3*u1 + q4*u2 - q1*u3)/2 + mu*q2",
        "q3": "(-q2*u1 + q1*u2 + q4*u3)/2 + mu*q3", "q4": "-(q1*u1 + q2*u2 + q3*u3)/2 + mu*q4",
    }  # fmt: skip
    force = {"n1": "u3*n2 - u2*n3", "n2": "u1*n3 - u3*n1", "n3": "u2*n1 - u1*n2"}
    moment = {"m1": "u3*m2 - u2*m3 + n2", "m2": "u1*m3 - u3*m1 - n1", "m3": "u2*m1 - u1*m2"}
    equations = d3 | turn | force | moment
    clamped = [f"{name}(start) = {int(name == 'q4')}" for name in (*d3, *turn)]
    model = contin.Model(
        "rod", kind="bvp", time={"name": "s", "from": 0, "to": 1},
        states={name: 1 if name == "q4" else "s" if name == "z" else 0 for name in equations},
        parameters={"T": 30, "mu": 0}, definitions={"u1": "m1", "u2": "m2/1.3", "u3": "m3/0.8"}, equations=equations,
        conditions=[*clamped, "x(end) = 0", "y(end) = 0", "q1(end) = 0", "q2(end) = 0", "q3(end) = 0", "n3(end) = -T",
                    "q1(end)^2 + q2(end)^2 + q3(end)^2 + q4(end)^2 = 1"],
    )  # fmt: skip
    line = api.continuation(api.boundary_problem(model, free=["mu"]), "T", (30, 60))
    assert [point.type for point in line.points] == ["BP"] * 2
    for point, load in zip(line.points, (4.0 * math.pi**2, 5.2 * math.pi**2), strict=True):
        assert abs(point.values["T"] - load) <= point.error < 1e-6
        form = point.normal_form
        assert form["kind"] == "pitchfork"
        assert form["b11"] == pytest.approx(1.0)
        assert abs(form["b30"]) > 1e5 * form["errors"]["b30"]
