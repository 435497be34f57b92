"""Branches that meet their own labelled points again have turned round."""

from types import SimpleNamespace

import numpy as np
import pytest

import contin
from contin.continuation.ends.retracing import until_retracing
from contin.model.model import Model


def followed(meetings, kind="orbit"):
    """Pieces up to which an arm is followed that locates these points in turn, and those it runs through again."""
    arm = SimpleNamespace(end=None, retraced=0, accepted=0, problem=SimpleNamespace(kind=kind, parameters=("p",)))
    arm.course, arm.is_over = SimpleNamespace(met=[]), lambda: arm.end is not None
    points = {name: SimpleNamespace(type=name.rstrip("0123456789"), z=np.array([0.0])) for name in meetings}
    seen = set()

    def segments():
        for name in meetings:
            arm.accepted += 6
            new = name not in seen
            seen.add(name)
            if not new:
                arm.course.met.append(points[name])
            yield SimpleNamespace(found=(SimpleNamespace(point=points[name]),) if new else ())

    return len(list(until_retracing(segments(), arm))), arm.retraced, arm.end


def test_the_way_back_ends_at_the_second_point_and_is_left_out():
    count, again, end = followed(["LPC1", "PD1", "LPC2", "PD2", "BPC1", "PD2", "LPC2", "PD1", "LPC1"])
    assert (count, again) == (7, 2)
    assert end.reason == "joined"
    assert "LPC" in end.text and "PD" in end.text  # noqa: PT018


@pytest.mark.parametrize("meetings", [["LPC1", "BPC1", "LPC2", "BPC1", "PD1", "BPC1"], ["LPC1", "LPC1", "PD1", "PD1"]])
def test_branch_points_and_steps_looked_at_twice_end_nothing(meetings):
    assert followed(meetings) == (len(meetings), 0, None)


@pytest.mark.long
def test_doubled_orbits_of_kopers_model_end_where_they_turn_round():
    """They come back to flips 1e-9 wide, beyond which they were followed along themselves for ever."""
    model = Model(
        "koper", states={"x": 0.1, "y": 0.1, "z": 0.1}, parameters={"lam": -7.0},
        equations={"x": "(-10*y - x^3 + 3*x - lam)/0.1", "y": "x - 2*y + z", "z": "y - z"},
    )  # fmt: skip
    found = contin.diagram(model, "lam", (-9.0, 9.0))
    assert sum(branch.steps for branch in found) < 5000
    assert not found.unfinished


def test_the_middle_of_a_figure_of_eight_is_one_label_and_nothing_is_missing():
    """p^2 = x^2 (1 - x^2) passes its branch point at 0 twice."""
    model = Model("eight", states={"x": 0.5}, parameters={"p": 0.25 * 3.0**0.5}, equations={"x": "p^2 - x^2*(1 - x^2)"})
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    assert [p.type for p in line.points].count("BP") == 1
    assert [end.reason for end in line.ends] == ["closed", "closed"]
    assert not line.notes
    assert line.unexplained == line.jumped == 0
