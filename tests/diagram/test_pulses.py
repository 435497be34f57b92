"""Orbits that rest for nearly all of their period and go round in one pulse."""

from __future__ import annotations

import numpy as np
import pytest

from contin.diagram.orbits import _same
from contin.problems.orbits.ends.multiply_traversed import _times_on, parts_apart
from contin.problems.orbits.mesh.layout import Profile, node_times

STILL = np.zeros(2)


def pulses(centres, width, sense=1.0):
    """x = sech s, y = -x tanh s with s = (t - c) / width, on a mesh that is fine there."""
    inner = np.concatenate([np.linspace(-20.0, 20.0, 41) * width + c for c in centres])
    h = np.diff(np.concatenate([[0.0], inner, [1.0]]))
    t = node_times(h, 4)
    s = [np.clip((t - c) / width, -300.0, 300.0) for c in centres]
    x = sum(1.0 / np.cosh(one) for one in s)
    y = -sum(np.tanh(one) / np.cosh(one) for one in s)
    return Profile(4, sense * np.column_stack([x, y]), 1e5, h, 0.0)


@pytest.mark.parametrize("width", [1e-2, 1e-3, 1e-4, 1e-5])
def test_a_pulse_is_not_its_mirror_image(width):
    """They have one period and rest at one place."""
    orbit = pulses([0.5017], width)
    assert _same(orbit, orbit, np.ones(2))
    assert _same(orbit, pulses([0.3], width), np.ones(2))  # in another phase
    assert not _same(orbit, pulses([0.5017], width, -1.0), np.ones(2))


@pytest.mark.parametrize("width", [1e-3, 1e-4, 1e-5])
def test_one_pulse_is_no_orbit_run_through_twice(width):
    """The family of a laser's pulses was "joined" to itself where they had become short beside the period."""
    for centres, twice in (([0.5017], False), ([0.2517, 0.7517], True)):
        orbit = pulses(centres, width)
        apart = np.abs(parts_apart(orbit, STILL, _times_on(orbit.mesh, 2), 2)).max()
        assert apart < 1e-6 if twice else apart > 0.5
