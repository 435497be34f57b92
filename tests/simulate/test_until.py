"""Trajectories that stop where a condition becomes true, against closed forms."""

import numpy as np
import pytest

import contin
from contin.errors import ContinError, InputError
from contin.model.model import Model

TURN = Model("turn", states={"x": 1, "y": 0}, parameters={"w": 1}, equations={"x": "w*y", "y": "-w*x"})
RELAY = Model("relay", states={"x": 0, "y": 1.5}, parameters={"c": 1}, equations={"x": "y", "y": "-c*sign(x)"})


def test_a_threshold_is_met_exactly():
    found = contin.simulate(TURN, time=100.0, until="y > 1/2")  # y = -sin t
    assert found.outcome == "event"
    assert found.end_time == pytest.approx(np.pi + np.arcsin(0.5), abs=1e-8)
    assert found.states[-1, 1] == pytest.approx(0.5, abs=1e-12)
    assert np.all(np.diff(found.t) > 0.0)


def test_conditions_are_combined():
    found = contin.simulate(TURN, time=100.0, until="x < 0 and x*y > 0")
    assert found.end_time == pytest.approx(np.pi / 2.0, abs=1e-8)  # third quadrant, entered through x = 0
    found = contin.simulate(TURN, time=100.0, until="x > 0.6 and y > 0")
    assert found.end_time == pytest.approx(2.0 * np.pi - np.arccos(0.6), abs=1e-8)


def test_a_condition_that_holds_at_the_start_must_first_become_false():
    found = contin.simulate(TURN, time=100.0, until="x > 0")
    assert found.end_time == pytest.approx(1.5 * np.pi, abs=1e-8)


def test_events_stand_beside_switching_surfaces():
    # parabolas between zeros at 2 v apart; v = 3/2: x rises through 1 at t = 3/2 - 1/2 after each multiple of 6
    found = contin.simulate(RELAY, time=100.0, transient=4.0, until="x > 1")
    assert found.end_time == pytest.approx(1.0, abs=1e-12)
    found = contin.simulate(RELAY, time=100.0, until="x < -1")
    assert found.end_time == pytest.approx(4.0, abs=1e-12)


def test_a_condition_that_holds_for_an_instant_is_found():
    found = contin.simulate(TURN, time=100.0, until="x < -0.999999 and y > 0")
    assert found.outcome == "event"
    assert found.end_time == pytest.approx(np.pi, abs=1e-7)


def test_an_event_that_never_comes_is_an_outcome():
    found = contin.simulate(TURN, time=20.0, until="x > 2")
    assert found.outcome == "no event"
    assert not found.complete
    assert "x > 2 did not come until t = 20" in str(found)


def test_maps_stop_at_the_first_iterate():
    model = Model("doubling", kind="map", states={"x": 1}, parameters={"a": 2}, equations={"x": "a*x"})
    assert contin.simulate(model, time=50.0, until="x > 100").states[-1, 0] == 128.0


@pytest.mark.parametrize(("until", "message"), [
    ("x", "number, not a condition"), ("x > z", "z"), ("x == 0", "crossed, not met"), ("__import__('os')", "until"),
])  # fmt: skip
def test_what_is_no_condition_is_refused(until, message):
    with pytest.raises(ContinError, match=message):
        contin.simulate(TURN, until=until)


def test_stiff_methods_have_no_events():
    with pytest.raises(InputError, match="DOP853"):
        contin.simulate(TURN, method="Radau", until="x < 0")
