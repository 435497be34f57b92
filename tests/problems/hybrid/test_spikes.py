"""Spikes that escape to infinity just beyond their surface, and intervals between them that grow without bound."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

import contin
from contin.problems.hybrid.flow import HybridFlow
from contin.problems.hybrid.landing import first_landing


@pytest.mark.seldom
def test_spikes_whose_intervals_grow_thirtyfold_have_their_period_their_height_and_their_multiplier():
    """v' = I + exp(v) from -10 to 20 takes (10 + log(I + exp(-10)))/I, less what is left at 20, where v' is 5e8.

    Beyond the surface v is infinite after 2e-9: two integrations of an interval differ by more.
    """
    model = contin.Model(
        "exponential", states={"v": -10, "u": 1}, parameters={"I": 1.0},
        equations={"v": "I + exp(v)", "u": "-0.1*u"}, events=[{"when": "v - 20", "set": {"v": "-10", "u": "u + 1"}}],
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "I", (0.02, 1.0))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert not branch.points
    assert not branch.notes
    current = branch.columns["I"]
    period = (10.0 + np.log(current + np.exp(-10.0)) - np.log1p(current * np.exp(-20.0))) / current
    np.testing.assert_allclose(branch.columns["period"], period, rtol=1e-10)
    np.testing.assert_allclose(branch.eigenvalues[:, 1].real, np.exp(-0.1 * period), atol=1e-10)
    np.testing.assert_allclose(branch.columns["v.max"], 20.0, rtol=1e-12)
    np.testing.assert_allclose(branch.columns["u.max"], 1.0 / (1.0 - np.exp(-0.1 * period)), rtol=1e-10)
    assert np.isfinite(branch.columns["norm"]).all()


def test_a_quadratic_neuron_stops_at_its_fold():
    """v' = I + v^2 from -10 to 10 takes 2 atan(10/sqrt(I))/sqrt(I)."""
    model = contin.Model(
        "quadratic", states={"v": -10}, parameters={"I": 1.0},
        equations={"v": "I + v^2"}, events=[{"when": "v - 10", "set": {"v": "-10"}}],
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "I", (-1.0, 1.5))
    end, root = branch.ends[0], np.sqrt(branch.columns["I"])
    assert end.reason == "homoclinic"
    assert abs(end.data["at"]["I"]) <= max(end.data["error"], 1e-15)
    assert end.data["saddle_node"]
    np.testing.assert_allclose(branch.columns["period"], 2.0 * np.arctan(10.0 / root) / root, rtol=1e-11)


@pytest.mark.seldom
def test_spikes_locked_to_a_clock_form_a_closed_family():
    """I = 1/(1 - e^-T) - c(s) for a spike at s, c = 0.3 (cos 6 s + 6 sin 6 s)/37: once round the clock."""
    model = contin.load(
        {
            "name": "clocked", "states": {"v": 0}, "parameters": {"I": 1.55}, "forcing": {"period": "2*pi/6"},
            "equations": {"v": "I - v + 0.3*cos(6*t)"},
            "events": [{"when": "v - 1", "direction": "up", "set": {"v": "0"}}],
        }
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(model), "I", (1.0, 2.0))
    assert {end.reason for end in family.ends} == {"closed"}
    middle, reach = 1.0 / (1.0 - np.exp(-np.pi / 3.0)), 0.3 / np.sqrt(37.0)
    assert [point.type for point in family.points] == ["LPC", "LPC"]
    for point, sign in zip(sorted(family.points, key=lambda p: p.values["I"]), (-1.0, 1.0), strict=True):
        assert abs(point.values["I"] - middle - sign * reach) <= max(point.error, 1e-13)
    assert not family.notes


def test_a_spike_that_samples_have_seen_is_not_looked_for_on_the_way_to_infinity(monkeypatch):
    """v' = 1 + v^2 from -1 meets v = 10 after atan(10) + pi/4, and is infinite 0.1 later: 24 flights more each."""
    landing = import_module("contin.problems.hybrid.landing")
    model = contin.Model(
        "quadratic", states={"v": -1, "u": 1}, parameters={"I": 1.0},
        equations={"v": "I + v^2", "u": "-0.1*u"}, events=[{"when": "v - 10", "set": {"v": "-1", "u": "u + 1"}}],
    )  # fmt: skip
    orbit, flights, fly = contin.periodic_orbit(model), [], landing._fly
    monkeypatch.setattr(landing, "_fly", lambda *given: flights.append(1) or fly(*given))
    towards = []
    monkeypatch.setattr(landing, "_towards_end", lambda *given: towards.append(1))
    assert abs(orbit.map.passage(orbit.u * 1.01, orbit.p).period - np.arctan(10.0) - np.pi / 4.0) < 1e-9
    assert not towards
    assert len(flights) < 20


def test_a_solution_that_escapes_before_it_is_looked_at_does_not_come_to_its_surface():
    """v' = v^2 from v0 is infinite at 1/v0, in less time than a solution beside its surface has to leave it."""
    flow = HybridFlow(contin.Model(
        "square", states={"v": 1}, parameters={"a": 1}, equations={"v": "a*v^2"},
        events=[{"when": "v - 30", "direction": "up", "set": {"v": "1"}}],
    ))  # fmt: skip
    for v in (68.5, 1e8):
        assert first_landing(flow, 0, np.array([v]), np.ones(1), np.array([30.0]), 10.0, 100.0) is None


def quadratic(surface: str) -> contin.Model:
    """v' = I + v^2 from -1 to 10 in (atan(10/sqrt I) + atan(1/sqrt I))/sqrt I; then u is raised by 1."""
    return contin.Model(
        "quadratic", states={"v": -1, "u": 1}, parameters={"I": 1.0, "one": 1.0, "two": 2.0, "three": 3.0},
        equations={"v": "I*one + v^2", "u": "-0.1*u*three/(one + two)"},
        events=[{"when": surface, "set": {"v": "-1", "u": "u + 1"}}],
    )  # fmt: skip


@pytest.mark.parametrize(("surface", "most"), [("v - 10", 2), ("one*v - 10", 2), ("(v - 10)*(1 + v^2)", 12)])
def test_at_a_plane_the_flight_to_it_ends(monkeypatch, surface, most):
    """Wherever it is, also beyond the time first looked at: two flights for each such time, the second to look closer.

    Without a plane it is looked for between samples and on the way to infinity.
    """
    landing, flow = import_module("contin.problems.hybrid.landing"), HybridFlow(quadratic(surface))
    flights, fly = [], landing._fly
    monkeypatch.setattr(landing, "_fly", lambda *given: flights.append(1) or fly(*given))
    p, sizes, time = np.array([1.0, 1.0, 2.0, 3.0]), np.array([10.0, 1.0]), np.arctan(10.0) + np.pi / 4.0
    for length, windows in ((time, 1), (0.5 * time, 2)):
        flights.clear()
        met = first_landing(flow, 0, np.array([-1.0, 2.0]), p, sizes, length, 100.0)
        assert abs(met - time) < 1e-10
        assert len(flights) <= most * windows


def test_a_plane_is_met_at_its_first_crossing_however_many_follow():
    """sin 60 s + s passes 0.9999 just before the ripple's first top, half a sample's time after the start."""
    model = contin.Model(
        "ripple", states={"s": 0, "y": 0, "z": 1}, parameters={"a": 60.0},
        equations={"s": "1", "y": "a*z", "z": "-a*y"}, events=[{"when": "y + s - 0.9999", "set": {"s": "0"}}],
    )  # fmt: skip
    met = first_landing(
        HybridFlow(model), 0, np.array([-1e-6, 0.0, 1.0]), np.array([60.0]), np.ones(3), 10.0, 100.0, leaves=False
    )
    low, high = 0.0, 0.5 * np.pi / 60.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sin(60.0 * middle) + middle < 0.9999 + 1e-6 else (low, middle)
    assert abs(met - low) < 1e-9


def test_differences_of_the_map_ask_for_lengths_along_their_own_directions(monkeypatch):
    """Of four parameters none is moved by a derivative along the state: two cycles beside it show the length."""
    module = import_module("contin.problems.hybrid.return_system")
    orbit, cycles, through = contin.periodic_orbit(quadratic("v - 10")), [], module.pass_through
    monkeypatch.setattr(module, "pass_through", lambda *given: cycles.append(1) or through(*given))
    along = np.zeros(orbit.map.n + orbit.map.m)
    along[0] = 1.0
    orbit.map.gradient(orbit.u * 1.01, orbit.p, along)
    assert len(cycles) <= 9


def test_an_orbit_a_hundred_times_shorter_than_the_first_keeps_its_event():
    """v' = I - v from 0 to 1 takes log(I/(I - 1)): 4.6 at the start, .02 at the end, where v begins .02 from 1."""
    model = contin.Model(
        "leaky", states={"v": 0, "u": 1}, parameters={"I": 1.01},
        equations={"v": "I - v", "u": "-0.1*u"}, events=[{"when": "v - 1", "set": {"v": "0", "u": "u + 1"}}],
    )  # fmt: skip
    settings = {"max_step": 0.5}
    branch = contin.continuation(contin.periodic_orbit(model), "I", (1.005, 50.0), settings=settings)
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    current = branch.columns["I"]
    np.testing.assert_allclose(branch.columns["period"], -np.log1p(-1.0 / current), rtol=1e-11)


def test_an_arc_that_begins_on_its_surface_leaves_it():
    """x'' = -1 from x = 0 at speed v comes back after 2 v, and is thrown up again: each arc begins where it ends."""
    model = contin.Model(
        "ball", states={"x": 1, "v": 0}, parameters={"g": 1.0, "w": 1.0},
        equations={"x": "v", "v": "-g"}, events=[{"when": "x", "direction": "both", "set": {"v": "w - v/2"}}],
    )  # fmt: skip
    orbit = contin.periodic_orbit(model)
    assert [arc.leaves for arc in orbit.map.arcs] == [True]
    branch = contin.continuation(orbit, "w", (0.01, 2.0))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    np.testing.assert_allclose(branch.columns["period"], 4.0 * branch.columns["w"], rtol=1e-10)


def test_spikes_steeper_than_their_clock_can_tell_are_simulated_and_followed():
    """v' = I + exp(v) from -10 to 60, where v' is 1e26: (10 + log(I + exp(-10)))/I to rounding; u' = -0.1 u + v/10.

    u gains Int v dt by the spike; its last moment counts for nothing. The peak is on its surface, not below it.
    """
    model = contin.Model(
        "steep", states={"v": -10, "u": 1}, parameters={"I": 1.0},
        equations={"v": "I + exp(v)", "u": "-0.1*u"}, events=[{"when": "v - 60", "set": {"v": "-10", "u": "u + 1"}}],
    )  # fmt: skip
    period = lambda current: (10.0 + np.log(current + np.exp(-10.0))) / current  # noqa: E731
    trajectory = contin.simulate(model, time=300.0)
    times = np.array([jump.time for jump in trajectory.jumps])
    np.testing.assert_allclose(times, period(1.0) * np.arange(1, len(times) + 1), rtol=1e-9)
    assert len(times) == 29
    branch = contin.continuation(contin.periodic_orbit(model), "I", (0.5, 1.5))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    np.testing.assert_allclose(branch.columns["period"], period(branch.columns["I"]), rtol=1e-11)
    np.testing.assert_allclose(branch.columns["v.max"], 60.0, rtol=1e-12)


def test_firing_stops_where_the_rest_is_on_the_threshold():
    """v' = I - v from 0 to 1 takes log(I/(I - 1)): without bound at I = 1, where v = 1 is at rest, and so is u = 0."""
    model = contin.Model(
        "leaky", states={"v": 0, "u": 1}, parameters={"I": 2.0},
        equations={"v": "I - v", "u": "-3*u"}, events=[{"when": "v - 1", "set": {"v": "0", "u": "u + 1"}}],
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "I", (0.5, 2.5))
    end = branch.ends[0]
    assert end.reason == "surface"
    assert abs(end.data["at"]["I"] - 1.0) <= end.data["error"] < 1e-12
    assert "v = 1, u = 0" in end.text
    assert not branch.notes
