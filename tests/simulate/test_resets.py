"""Trajectories with jumps against closed forms."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

FIRE = Model(
    "fire", states={"v": 0}, parameters={"I": 1.5}, equations={"v": "I - v"},
    events=[{"when": "v - 1", "direction": "up", "set": {"v": 0}}],
)  # fmt: skip
BALL = Model(
    "ball", states={"x": 1, "v": 0}, parameters={"g": 9.81, "r": 0.8}, equations={"x": "v", "v": "-g"},
    events=[{"when": "x", "direction": "down", "set": {"v": "-r*v"}}],
)  # fmt: skip
FALL = np.sqrt(2.0 / 9.81)


def kicks(*events, **states):
    """Clocks x' = 1, other states at rest."""
    names = {"x": 0, "y": 0, "z": 0} | states
    return Model("kicks", states=names, equations={"x": "1", "y": "0", "z": "0"}, events=list(events))


@pytest.mark.parametrize("current", [1.01, 1.5, 20.0])
def test_integrate_and_fire_has_its_period(current):
    period = np.log(current / (current - 1.0))
    found = contin.simulate(FIRE, parameters={"I": current}, time=10.5 * period)
    times = np.array([j.time for j in found.jumps])
    np.testing.assert_allclose(times, period * np.arange(1, 11), rtol=1e-8)
    assert all(j.before[0] == pytest.approx(1.0, abs=1e-12) and j.after[0] == 0.0 for j in found.jumps)
    phase = np.mod(found.t, period)
    inside = (phase > 1e-6 * period) & (phase < (1.0 - 1e-6) * period)
    np.testing.assert_allclose(found.states[inside, 0], current * -np.expm1(-phase[inside]), atol=1e-7)


@pytest.mark.parametrize("r", [0.5, 0.8, 0.95])
def test_a_bouncing_ball_ends_where_its_bounces_accumulate(r):
    found = contin.simulate(BALL, parameters={"r": r}, time=100.0)
    end = FALL * (1.0 + 2.0 * r / (1.0 - r))
    assert found.outcome == "stopped"
    assert f"infinitely many events before t = {end:.6g}"[:-1] in found.why
    times = np.array([j.time for j in found.jumps])
    bounces = FALL * (1.0 + 2.0 * np.array([r * (1.0 - r**k) / (1.0 - r) for k in range(len(times))]))
    np.testing.assert_allclose(times, bounces, rtol=1e-10)
    assert end - times[-1] < 1e-4
    assert found.states[:, 0].min() > -1e-12


def test_an_elastic_ball_keeps_its_energy():
    found = contin.simulate(BALL, parameters={"r": 1.0}, time=60.0 * FALL)
    assert found.complete
    assert len(found.jumps) == 30
    energy = 0.5 * found.states[:, 1] ** 2 + 9.81 * found.states[:, 0]
    np.testing.assert_allclose(energy, 9.81, rtol=1e-9)


def test_a_ball_that_does_not_bounce_rests_in_words():
    found = contin.simulate(BALL, parameters={"r": 0.0}, time=10.0)
    assert found.outcome == "stopped"
    assert "leaves the solution on its own surface" in found.why
    assert found.end_time == pytest.approx(FALL, abs=1e-10)


def test_values_before_the_jump_are_used_and_swapped():
    model = kicks({"when": "x - 1", "direction": "up", "set": {"y": "z", "z": "y + t"}}, y=2, z=5)
    found = contin.simulate(model, time=2.0)
    assert len(found.jumps) == 1
    np.testing.assert_allclose(found.states[-1], [2.0, 5.0, 3.0], rtol=1e-12)


@pytest.mark.parametrize(("direction", "times"), [("up", [2.0]), ("down", [1.0]), ("both", [1.0, 2.0])])
def test_directions(direction, times):
    event = {"when": "(x - 1)*(x - 2)", "direction": direction, "set": {"y": "y + 1"}}
    found = contin.simulate(kicks(event), time=3.0)
    np.testing.assert_allclose([j.time for j in found.jumps], times, rtol=1e-10)


def test_touching_and_starting_at_zero_are_no_events():
    model = kicks({"when": "(x - 1)^2", "set": {"y": "1"}}, {"when": "x", "set": {"z": "1"}})
    found = contin.simulate(model, time=2.0)
    assert not found.jumps


def test_a_jump_through_zero_fires_at_the_same_time_afterwards():
    second = {"when": "y - 0.5", "direction": "up", "set": {"z": "y + 10"}}
    model = kicks({"when": "x - 1", "direction": "up", "set": {"y": 3}}, second)
    found = contin.simulate(model, time=2.0)
    assert [j.events for j in found.jumps] == [(0,), (1,)]
    assert found.jumps[1].time == found.jumps[0].time
    assert found.states[-1, 2] == 13.0


def test_events_at_once_that_disagree_end_in_words():
    both = [{"when": "x - 1", "direction": "up", "set": {"y": k}} for k in (1, 2)]
    found = contin.simulate(kicks(*both), time=2.0)
    assert found.outcome == "stopped"
    assert "two events at the same time set y to 1 and to 2" in found.why
    agreed = contin.simulate(kicks(both[0], {**both[0], "set": {"z": "y + 1"}}), time=2.0)
    assert agreed.complete
    np.testing.assert_allclose(agreed.states[-1], [2.0, 1.0, 1.0])


def test_events_that_fire_each_other_end_in_words():
    model = kicks(
        {"when": "x - 1", "direction": "up", "set": {"y": 1}},
        {"when": "y - 0.5", "direction": "up", "set": {"y": 0, "z": "1 - z"}},
        {"when": "abs(z - 0.5)*(0.5 - y)", "direction": "up", "set": {"y": 1}},
    )
    found = contin.simulate(model, time=2.0)
    assert "without end" in found.why


def test_the_model_file_keeps_its_events_and_other_verbs_refuse_them():
    again = Model("x", **{k: v for k, v in contin_entries(FIRE).items() if k not in ("name", "contin")})
    assert again.events == FIRE.events
    for refused in (lambda: contin.equilibrium(FIRE), lambda: contin.sweep(FIRE, "I", (1, 3))):
        with pytest.raises(InputError, match="its periodic orbits be followed"):
            refused()
    with pytest.raises(InputError, match="until"):
        contin.simulate(FIRE, until="v > 0.5")
    with pytest.raises(InputError, match="DOP853 only"):
        contin.simulate(FIRE, method="Radau")


def contin_entries(model):
    from ruamel.yaml import YAML

    return YAML(typ="safe").load(model.text())


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ({"when": "p", "set": {"v": 0}}, "never crosses zero"),
        ({"when": "v", "set": {"w": 0}}, "w is not a state"),
        ({"when": "v", "set": {}}, "nothing jumps"),
        ({"when": "v", "direction": "upp", "set": {"v": 0}}, "expected up, down or both"),
        ({"when": "mod(t, 2) - 1", "set": {"v": 0}}, "jump over zero"),
    ],
)
def test_mistakes_are_told(event, words):
    with pytest.raises(InputError, match=words):
        Model("bad", states={"v": 0}, parameters={"p": 1}, equations={"v": "p"}, events=[event])


def test_tables_and_pictures_know_the_jumps():
    found = contin.simulate(FIRE, time=3.0, samples=50)
    assert list(found.events) == ["t", "event", "v.before", "v.after"]
    assert len(found.events["t"]) == len(found.jumps) == 2
    drawn = found.drawn
    assert np.isnan(drawn["v"]).sum() == 2
    assert np.all(np.diff(drawn["t"]) >= 0.0)
    assert len(found.columns["t"]) == 50
    assert "2 jumps" in str(found)


@pytest.mark.parametrize("apart", [1e-4, 1e-6, 1e-8])
def test_two_events_as_good_as_at_once_each_ring_once_a_turn(apart):
    """An event that leaves its own `when` as it is must not ring again because another one rings just after it."""
    model = contin.Model(
        "two", states={"x": 0, "v": 1, "y": f"sin({apart})", "w": f"cos({apart})"},
        equations={"x": "v", "v": "-x", "y": "w", "w": "-y"},
        events=[
            {"when": "x - 0.3", "direction": "up", "set": {"v": "v*(1 + 1e-9)"}},
            {"when": "y - 0.3", "direction": "up", "set": {"w": "w*(1 + 1e-9)"}},
        ],
    )  # fmt: skip
    found = contin.simulate(model, time=64 * 2 * np.pi, samples=2)
    assert found.complete, found.why
    rung = [k for jump in found.jumps for k in jump.events]
    assert rung.count(0) == rung.count(1) == 64


@pytest.mark.parametrize("height", [0.0, 1e-9])
def test_a_flight_that_begins_on_its_surface_has_its_height_on_the_way(height):
    """x'' = -1 thrown up at speed 1 from a floor at .3 that rounding moves: every 2, also when first seen below it."""
    model = contin.Model(
        "ball", states={"x": 0.3 + height, "v": 1.0}, parameters={"A": 0.3}, equations={"x": "v", "v": "-1"},
        events=[{"when": "x - A", "direction": "both", "set": {"x": "sqrt(A)*sqrt(A)", "v": "-v"}}],
    )  # fmt: skip
    found = contin.simulate(model, time=301.0)
    np.testing.assert_allclose([jump.time for jump in found.jumps], 2.0 * np.arange(1, 151), atol=1e-6)
