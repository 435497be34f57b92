"""The family of half the period, from an orbit that runs through one of its orbits twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import contin
from contin.errors import NoSolutionError
from contin.transitions.halved import halved


def twice(problem, z):
    """The orbit z run through twice, as an orbit."""
    profile = problem.profile(z)
    u = np.concatenate([profile.u, profile.u[1:]])
    return replace(profile, u=u, period=2.0 * profile.period, h=0.5 * np.tile(profile.h, 2)).vector()


@pytest.mark.parametrize("m", [1.0, 50.0])
def test_an_orbit_run_through_twice_leads_to_the_orbit_also_where_it_is_steep(m):
    """Van der Pol's relaxation oscillation: with m = 50 it jumps within a part of 1e-3 of its period."""
    model = contin.Model(
        "vdp", states={"x": 2, "y": 0}, parameters={"m": m}, equations={"x": "y", "y": "m*(1 - x^2)*y - x"}
    )
    family = contin.continuation(contin.periodic_orbit(model), "m", (m, 1.2 * m), settings={"steps": 1})
    found = halved(family.problem, twice(family.problem, family.z[0]))
    period = found.problem.profile(found.z).period
    assert abs(period - family.columns["period"][0]) < 1e-6 * period


def test_where_there_is_none_the_message_speaks_of_families():
    model = contin.load("classics/brusselator")
    family = contin.continuation(
        contin.periodic_orbit(model, {"x": 1.3, "y": 2}, {"B": 2.5}), "B", (2.5, 2.6), settings={"steps": 1}
    )
    z = twice(family.problem, family.z[0])
    spoiled = z.copy()
    spoiled[: len(z) // 2] = 50.0 * np.sin(np.arange(len(z) // 2))
    with pytest.raises(NoSolutionError, match=r"half their period|equilibrium"):
        halved(family.problem, spoiled)
