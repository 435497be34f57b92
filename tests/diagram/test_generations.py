"""Which families of orbits that were born on others an explorer follows; births only say that they were asked."""

from types import SimpleNamespace

import pytest

from contin.continuation.branch import End
from contin.continuation.settings import Settings
from contin.diagram import explore
from contin.diagram.diagram import Diagram
from contin.diagram.explore import Explorer
from contin.problems.orbits.collocated_orbits import OrbitProblem

LIMITED = {"generations": 1, "unstable_births": False}


@pytest.fixture(autouse=True)
def seeds(monkeypatch):
    monkeypatch.setattr(explore, "departures", lambda *_: ["a seed"])


def born(born_at, type_, unstable, asked=False, **limits):
    explorer = Explorer("p", (0.0, 1.0), Settings(), **limits)
    ends, problem = (End("bound", ""), End("bound", "")), object.__new__(OrbitProblem)
    branch = SimpleNamespace(name="family", kind="orbit", ends=ends, problem=problem, born_at=tuple(born_at.split()))
    point = SimpleNamespace(type=type_, label=f"{type_}1", values={"unstable": unstable, "period": 1.0})
    diagram = Diagram("p", (0.0, 1.0), explorer=explorer)
    return explorer._departures(diagram, branch, point, asked), diagram.notes


@pytest.mark.parametrize(
    ("born_at", "type_", "unstable", "followed"),
    [
        ("HB", "PD", 0, True),
        ("HB", "PD", 1, False),
        ("HB", "BPC", 2, False),
        ("HB", "HOM", 1, True),  # beyond a homoclinic orbit two families may glue to a stable one
        ("HB BPC", "PD", 0, False),
        ("HB HOM", "BPC", 0, False),
    ],
)
def test_limits_leave_out_late_and_unstable_births_and_say_so(born_at, type_, unstable, followed):
    found, notes = born(born_at, type_, unstable, **LIMITED)
    assert bool(found) is followed
    assert bool(notes) is not followed
    assert born(born_at, type_, unstable)[0]  # a diagram in one parameter has no such limits
    assert born(born_at, type_, unstable, asked=True, **LIMITED)[0]  # and users may always go on


def test_points_that_lead_nowhere_are_not_noted():
    assert born("HB PD", "LPC", 1, **LIMITED)[1] == []
