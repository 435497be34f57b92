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
