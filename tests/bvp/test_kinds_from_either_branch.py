"""A branch point is of one kind, seen from either branch that crosses there: rounding decides nothing."""

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
