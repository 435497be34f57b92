"""Orbits by shooting that a simulation found have their own period, not several of them."""

import numpy as np
import pytest

import contin
from contin.machine import elementary

BILINEAR = contin.Model(  # a forced oscillator that is stiffer beyond a stop (Shaw and Holmes 1983)
    "bilinear", states={"x": 0, "v": 0}, parameters={"om": 0.3, "k": 4, "g": 1.2, "F": 0.5, "z": 0.05},
    forcing={"period": "2*pi/om"}, equations={"x": "v", "v": "F*cos(om*t) - x - 2*z*v - (k*(x - g) if x > g else 0)"},
)  # fmt: skip


@pytest.mark.parametrize("om", [0.25, 0.3])
def test_a_response_that_does_not_reach_the_stop_has_the_period_of_the_forcing(om):
    """x = A cos(om t + phase) below the stop: multipliers have the product exp(-2 z T), T = 2 pi/om."""
    orbit = contin.periodic_orbit(BILINEAR, {"x": 0, "v": 0}, {"om": om})
    assert orbit.period == pytest.approx(2 * np.pi / om, rel=1e-12)
    line = contin.continuation(orbit, "om", (om, 1.02 * om))
    size = 0.5 / np.hypot(1 - om**2, 2 * 0.05 * om)
    assert line.columns["x.max"][0] == pytest.approx(size, rel=1e-8)
    product = np.prod(line.eigenvalues[0])
    assert product.real == pytest.approx(float(elementary.exp(-2 * 0.05 * orbit.period)), rel=1e-6)


def test_a_doubling_of_the_response_is_one():
    """Newton on the stroboscopic map, by Dormand and Prince, has the multiplier -1 between .782 and .7825."""
    orbit = contin.periodic_orbit(BILINEAR, {"x": 0, "v": 0}, {"om": 0.7})
    line = contin.continuation(orbit, "om", (0.7, 0.785))
    assert [p.type for p in line.points] == ["PD"]
    assert 0.782 < line["PD1"].values["om"] < 0.7825


def test_a_cycle_of_a_switched_oscillator_has_one_loop():
    """x'' + d (sign-like) damping: two linear pieces; the cycle is reached by a slow transient."""
    model = contin.Model(
        "switched", states={"x": 0.4, "v": 0}, parameters={"d": 0.02, "w": 1.0},
        equations={"x": "v", "v": "-w*x + (d*v if abs(x) < 1 else -d*v)"},
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, {"x": 0.4, "v": 0})
    assert orbit.period == pytest.approx(2 * np.pi, rel=0.05)


@pytest.mark.parametrize(("r", "events"), [(2.95, 1), (3.44, 2), (3.5, 4)])
def test_a_flow_with_jumps_of_the_logistic_map_has_the_cycles_of_the_map(r, events):
    """At each tick y becomes r y (1 - y): the fixed point's multiplier is 2 - r, the 2-cycle's 4 + 2 r - r^2."""
    model = contin.Model(
        "clocked", states={"y": 0.3, "c": 0}, parameters={"r": r}, equations={"y": "0*y", "c": 1},
        events=[{"when": "c - 1", "direction": "up", "set": {"c": 0, "y": "r*y*(1 - y)"}}],
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, {"y": 0.3, "c": 0})
    assert len(orbit.events) == events
    assert orbit.period == pytest.approx(events, rel=1e-9)


@pytest.mark.parametrize(("r", "period"), [(2.95, 1), (2.999, 1), (3.001, 2), (3.44, 2), (3.449, 2), (3.5, 4)])
def test_iterates_of_a_map_lead_to_cycles_of_their_own_period(r, period):
    """Next to a doubling they alternate about the fixed point, or the 2-cycle, for long."""
    model = contin.Model("logistic", kind="map", states={"y": 0.3}, parameters={"r": r}, equations={"y": "r*y*(1 - y)"})
    found = contin.find_start(model)
    orbit = [float(found.solution.u[0])]
    for _ in range(period):
        orbit.append(r * orbit[-1] * (1.0 - orbit[-1]))
    assert [abs(y - orbit[0]) < 1e-9 for y in orbit[1:]] == [False] * (period - 1) + [True]
    assert ("fixed point" in str(found)) == (period == 1)
    assert (f"cycle of period {period}" in str(found)) == (period > 1)
