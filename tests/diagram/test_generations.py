"""Which families of orbits that were born on others an explorer follows; the problem only says that it was asked."""

from types import SimpleNamespace

import pytest

from contin.continuation.branch import End
from contin.continuation.settings import Settings
from contin.diagram.diagram import Diagram
from contin.diagram.explore import Explorer

LIMITED = {"generations": 1, "unstable_births": False}


def born(name, type_, unstable, asked=False, **limits):
    explorer = Explorer("p", (0.0, 1.0), Settings(), **limits)
    problem = SimpleNamespace(departures=lambda *_: ["a seed"])
    branch = SimpleNamespace(name=name, kind="orbit", ends=(End("bound", ""), End("bound", "")), problem=problem)
    point = SimpleNamespace(type=type_, label=f"{type_}1", values={"unstable": unstable, "period": 1.0})
    diagram = Diagram("p", (0.0, 1.0), explorer=explorer)
    return explorer._departures(diagram, branch, point, asked), diagram.notes


@pytest.mark.parametrize(
    ("name", "type_", "unstable", "followed"),
    [
        ("start/HB1", "PD", 0, True),
        ("start/HB1", "PD", 1, False),
        ("start/HB1", "BPC", 2, False),
        ("start/HB1", "HOM", 1, True),  # beyond a homoclinic orbit two families may glue to a stable one
        ("start/HB1/BPC1", "PD", 0, False),
        ("start/HB1/HOM1", "BPC", 0, False),
    ],
)
def test_limits_leave_out_late_and_unstable_births_and_say_so(name, type_, unstable, followed):
    found, notes = born(name, type_, unstable, **LIMITED)
    assert bool(found) is followed
    assert bool(notes) is not followed
    assert born(name, type_, unstable)[0]  # a diagram in one parameter has no such limits
    assert born(name, type_, unstable, asked=True, **LIMITED)[0]  # and users may always go on


def test_points_that_lead_nowhere_are_not_noted():
    assert born("start/HB1/PD1", "LPC", 1, **LIMITED)[1] == []
