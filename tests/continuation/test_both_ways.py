"""A closed curve is closed, whatever number of steps each way from its start takes: once, and with no other notes."""

import numpy as np
import pytest

import contin

CIRCLE = """
contin: 1
name: circle
states: {x: 1}
parameters: {p: {value: 0, range: [-2, 2]}}
equations: {x: 1 - x^2 - p^2}
"""


def turned(branch):
    """The whole angle that the rows pass on the circle."""
    angle = np.unwrap(np.arctan2(branch.columns["p"], branch.columns["x"]))
    return abs(float(angle[-1] - angle[0]))


@pytest.fixture(scope="module")
def circle(tmp_path_factory):
    path = tmp_path_factory.mktemp("circle") / "circle.yaml"
    path.write_text(CIRCLE)
    return contin.load(path)


def test_both_ways_round_a_circle_meet_once(circle):
    ends = set()
    for steps in range(4, 60):
        branch = contin.continuation(contin.equilibrium(circle), "p", (-2.0, 2.0), settings={"steps": steps})
        reasons = {end.reason for end in branch.ends}
        ends |= reasons
        assert turned(branch) <= 2.0 * np.pi + 1e-9
        assert not branch.notes
        if reasons == {"closed"}:
            assert turned(branch) == pytest.approx(2.0 * np.pi, abs=1e-9)
            assert sorted(round(p.values["p"], 9) for p in branch.points) == [-1.0, 1.0]
        else:
            assert reasons == {"steps"}
            assert turned(branch) < 2.0 * np.pi
    assert ends == {"closed", "steps"}


@pytest.mark.seldom
def test_both_ways_from_a_branch_point_meet_once():
    """x (1 - x^2 - p^2) = 0: the circle from its crossing with x = 0 at p = 1, born there, from places beside it."""
    problem = contin.FunctionProblem(
        lambda u, p: u * (1.0 - u**2 - p["p"] ** 2), [0.0], {"p": 0.0},
        lambda u, p: np.array([[1.0 - 3.0 * u[0] ** 2 - p["p"] ** 2]]),
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(problem), "p", (-0.5, 1.5))
    for steps in range(10, 60, 3):
        branch = contin.continuation(line["BP1"].switch(), "p", (-2.0, 2.0), settings={"steps": steps})
        angle = np.unwrap(np.arctan2(branch.z[:, 0], branch.z[:, 1]))
        assert abs(float(angle[-1] - angle[0])) <= 2.0 * np.pi + 1e-9
        assert not branch.notes, (steps, branch.notes)
