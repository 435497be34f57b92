"""Cycles of piecewise linear flows that shrink in proportion to the parameter onto an equilibrium at a corner."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin


def test_a_cycle_of_two_foci_shrinks_to_the_equilibrium_where_they_meet():
    """x' = -y + t x, y' = x - mu with t = -0.8 for x < 0, 0.3 for x > 0: a scale of x, y and mu changes nothing."""
    model = contin.Model(
        "foci", states={"x": 2, "y": 0}, parameters={"mu": 1},
        equations={"x": "-y + (-0.8*x if x < 0 else 0.3*x)", "y": "x - mu"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "mu", (-1.0, 1.5))
    first, last = branch.ends
    assert (first.reason, last.reason) == ("hopf", "bound")
    assert abs(first.data["at"]["mu"]) <= max(first.data["error"], 1e-12)
    mu, period = branch.columns["mu"][1:], branch.columns["period"][1:]
    assert period == pytest.approx(period[-1], rel=1e-8)
    assert branch.columns["x.max"][1:] / mu == pytest.approx(branch.columns["x.max"][-1] / mu[-1], rel=1e-7)
    assert branch.steps < 100


@pytest.mark.seldom
def test_a_family_between_two_corners_has_two_ends_and_is_no_closed_loop():
    """A saturated oscillator: its equilibrium x = mu is an unstable focus for |mu| < 1 and a stable one beyond."""
    model = contin.Model(
        "saturated", states={"x": 1, "y": 0}, parameters={"mu": 0.2},
        equations={"x": "y + 1.5*x if abs(x) < 1 else (y + 1.5 - 3*(x - 1) if x > 0 else y - 1.5 - 3*(x + 1))",
                   "y": "mu - x"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "mu", (-1.5, 1.5))
    assert [end.reason for end in branch.ends] == ["hopf", "hopf"]
    for end, at in zip(branch.ends, (-1.0, 1.0), strict=True):
        assert abs(end.data["at"]["mu"] - at) <= max(10.0 * end.data["error"], 1e-10)
    assert not branch.points


def test_cycles_of_a_centre_that_reach_a_corner_go_on_beyond_it_and_not_back_to_the_centre():
    """x'' = -x + a x', less 2 x' where |x| > 1: all cycles up to the amplitude 1 are at a = 0, with the period 2 pi.

    Where the phase is moved, parameter and period say nothing of the way along them. Beyond, x(T) is x(0) by DOP853.
    """
    model = contin.Model(
        "damped", states={"x": 0, "y": 0}, parameters={"a": -0.5},
        equations={"x": "y", "y": "-x + a*y - (0 if abs(x) < 1 else 2*y)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (-0.5, 0.5))
    branch = contin.continuation(line["HB1"].switch(), "a", (-0.5, 0.5))
    assert branch.ends[1].reason == "bound"
    top, a = branch.columns["x.max"], branch.columns["a"]
    assert np.all(np.diff(top) > 0.0)
    assert np.abs(a[top < 1.0]).max() < 1e-9

    def rates(t, u):
        return [u[1], -u[0] + a[-1] * u[1] - (0.0 if abs(u[0]) < 1.0 else 2.0 * u[1])]

    end = solve_ivp(
        rates, (0.0, branch.columns["period"][-1]), [top[-1], 0.0], method="DOP853", rtol=1e-9, atol=1e-10
    ).y[:, -1]
    assert end == pytest.approx([top[-1], 0.0], abs=1e-5)


@pytest.mark.parametrize("start", [1.0, 1.4])  # where steps of this length end on both sides of the equilibrium
def test_cycles_of_a_centre_that_steps_pass_over_end_there(start):
    """x'' = -x + mu x' to |x'| = 1, damped beyond: the cycles up to the amplitude 1 are at mu = 0."""
    model = contin.Model(
        "saturated", states={"x": start, "y": 0.1}, parameters={"mu": 0.1},
        equations={"x": "y", "y": "-x + mu*y - 0.3*(y - 1 if y > 1 else (y + 1 if y < -1 else 0))"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "mu", (-0.2, 0.12), settings={"max_step": 0.3})
    assert [end.reason for end in branch.ends] == ["hopf", "bound"]
    assert abs(branch.ends[0].data["at"]["mu"]) < 1e-13
    assert np.all(np.diff(branch.columns["x.max"]) > 0.0)


def test_a_clock_whose_section_becomes_tangent_in_a_last_step_is_followed_to_rest():
    """x'' + x'/10 + x = f sign(x') where |x| < 1/5: to the amplitude 1/5 a scale of x and f changes nothing, and the
    period is that of damped turns."""
    model = contin.Model(
        "clock", states={"x": 1.0, "v": 0.0}, parameters={"f": 0.1},
        equations={"x": "v", "v": "-x - 0.1*v + (f*sign(v) if abs(x) < 0.2 else 0)"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "f", (0.0, 0.5))
    assert [end.reason for end in branch.ends] == ["hopf", "bound"]
    assert abs(branch.ends[0].data["at"]["f"]) < 1e-14
    f, top = branch.columns["f"], branch.columns["x.max"]
    assert np.all(np.diff(f) > 0.0)
    assert np.all(np.diff(top) > 0.0)
    small = (top > 1e-6) & (top < 0.199)
    np.testing.assert_allclose(branch.columns["period"][small], 2.0 * np.pi / np.sqrt(1.0 - 0.0025), rtol=1e-10)
    np.testing.assert_allclose(top[small] / f[small], (top / f)[small][0], rtol=1e-8)
