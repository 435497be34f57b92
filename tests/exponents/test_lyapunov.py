"""Lyapunov exponents beside closed forms, multipliers of cycles, invariances and published values.

Published: Sprott, Chaos and Time-Series Analysis (Oxford 2003), appendix A.
"""

from __future__ import annotations

import importlib

import numpy as np
import pytest

import contin
from contin.exponents.disturbances import logarithms


def lorenz(unit=1.0):
    return contin.Model(
        "lorenz", states={"x": 1, "y": 1, "z": 20}, parameters={"s": 10, "r": 28, "b": 8 / 3},
        equations={"x": f"{unit}*s*(y - x)", "y": f"{unit}*(r*x - y - x*z)", "z": f"{unit}*(x*y - b*z)"},
    )  # fmt: skip


def roessler(start=(1, 1, 0)):
    return contin.Model(
        "roessler", states=dict(zip("xyz", start, strict=True)), parameters={"a": 0.2, "b": 0.2, "c": 5.7},
        equations={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    )  # fmt: skip


def henon():
    return contin.Model(
        "henon", kind="map", states={"x": 0.1, "y": 0.1}, parameters={"a": 1.4, "b": 0.3},
        equations={"x": "1 - a*x^2 + y", "y": "b*x"},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("model", "published", "dimension", "sum_of_all", "time"),
    [
        (lorenz(), (0.9056, 0.0, -14.5723), 2.06215, -(10 + 1 + 8 / 3), 400.0),
        (roessler(), (0.0714, 0.0, -5.3943), 2.0132, None, 2000.0),
        (henon(), (0.41922, -1.62319), 1.25827, np.log(0.3), 5000.0),
    ],
    ids=["Lorenz", "Roessler", "Henon"],
)
def test_published_values_lie_within_the_stated_errors(model, published, dimension, sum_of_all, time):
    found = contin.lyapunov(model, time=time, transient=100.0)
    off = np.abs(found.exponents - published)
    assert (off < 1.5 * found.errors + 1e-4).all()  # 95 %, and the published ones are rounded
    assert (found.errors < 0.05 * np.abs(published).max()).all()
    assert found.signs[0].split()[0] == "+"
    assert abs(found.dimension - dimension) < 0.02
    if sum_of_all is not None:  # the mean divergence is constant
        assert abs(found.exponents.sum() - sum_of_all) < 1e-6


def test_the_logistic_map_doubles_at_four_and_a_superstable_cycle_forgets_at_once():
    model = contin.Model("logistic", kind="map", states={"x": 0.1}, parameters={"a": 4}, equations={"x": "a*x*(1 - x)"})
    found = contin.lyapunov(model, time=10_000)
    assert abs(found.exponents[0] - np.log(2.0)) < 1.5 * found.errors[0] < 0.01
    still = contin.lyapunov(model, {"x": 0.5}, {"a": 2}, time=100)
    assert still.exponents[0] == -np.inf
    assert still.signs == ["-"]
    assert still.dimension == 0.0


@pytest.mark.parametrize(
    ("name", "start", "parameter", "value"),
    [("metronomes/one", None, "eps", 0.2), ("classics/brusselator", {"x": 1.3, "y": 2}, "B", 2.5)],
)
def test_of_a_cycle_they_are_the_logarithms_of_its_multipliers_over_its_period(name, start, parameter, value):
    model, values = contin.load(name), {parameter: value}
    family = contin.continuation(
        contin.periodic_orbit(model, start, values), parameter, (value, 1.1 * value), settings={"steps": 1}
    )
    orbit = family.orbit(0)
    period, multipliers = orbit.period, np.abs(orbit.multipliers)
    found = contin.lyapunov(model, start, values, time=120 * period, transient=40 * period)
    expected = np.sort([0.0, np.log(multipliers.min()) / period])[::-1]
    np.testing.assert_allclose(found.exponents, expected, atol=5e-3 * abs(expected[1]))
    assert (np.abs(found.exponents - expected) < found.errors).all()
    assert found.signs == ["0 -"]
    assert abs(found.dimension - 1.0) < 1e-2


def test_of_an_equilibrium_they_are_the_real_parts_of_its_eigenvalues():
    model = contin.Model(
        "focus", states={"x": 1, "y": 0, "z": 1},
        equations={"x": "-0.2*x + 5*y", "y": "-5*x - 0.2*y", "z": "-3*z + x*y"},
    )  # fmt: skip
    found = contin.lyapunov(model, time=100.0)
    np.testing.assert_allclose(found.exponents, [-0.2, -0.2, -3.0], atol=1e-3)
    assert (np.abs(found.exponents - [-0.2, -0.2, -3.0]) < found.errors).all()


def test_two_oscillators_that_do_not_feel_each_other_move_on_a_torus():
    model = contin.Model(
        "two", states={"x": 2, "y": 0, "u": 1, "v": 1},
        equations={"x": "y", "y": "(1 - x^2)*y - x", "u": "v", "v": "(0.5 - u^2)*v - 1.7*u"},
    )  # fmt: skip
    found = contin.lyapunov(model, time=800.0)
    assert found.signs == ["0 0 - -"]
    assert abs(found.dimension - 2.0) < 0.02
    assert found.errors[:2].max() < 1e-2


def test_the_unit_of_time_divides_them_and_the_units_of_states_do_not_matter():
    slow, fast = contin.lyapunov(lorenz(), time=50.0), contin.lyapunov(lorenz(1e6), time=50e-6)
    assert abs(fast.exponents.sum() / slow.exponents.sum() - 1e6) < 1.0
    assert np.abs(fast.exponents * 1e-6 - slow.exponents).max() < 0.2 * abs(slow.exponents.sum())
    small = contin.Model(
        "small", states={"x": 1e-9, "y": 0}, parameters={"m": -0.3},
        equations={"x": "m*x - 4*y + 1e18*x^3 - 2e18*x^3", "y": "4*x + m*y"},
    )  # fmt: skip
    np.testing.assert_allclose(contin.lyapunov(small, time=100.0).exponents, -0.3, atol=2e-3)


@pytest.mark.parametrize("tilt", [pytest.param(0.0, marks=pytest.mark.long), 0.3])
@pytest.mark.seldom
def test_jumps_carry_disturbances_by_their_saltation_matrix(tilt):
    """A clock s that rings at 1 and iterates the logistic map: ln 2 and 0, also where the bell's time depends on x."""
    after = "4*x*(1 - x)"
    model = contin.Model(
        "bell", states={"x": 0.1, "w": -0.1 * tilt}, equations={"x": "0", "w": "1"},
        events=[{"when": f"w + {tilt}*x - 1", "direction": "up", "set": {"x": after, "w": f"-{tilt}*{after}"}}],
    )  # fmt: skip
    found = contin.lyapunov(model, time=300.0, transient=10.0)
    assert abs(found.exponents[0] - np.log(2.0)) < 1.5 * found.errors[0] < 0.1
    assert abs(found.exponents[1]) < 1e-2


@pytest.mark.seldom
def test_a_forced_impact_oscillator_loses_what_its_impacts_and_damping_take():
    """Each impact multiplies areas in (x, v) by r^2, damping by exp(-c) a time unit: the sum, exactly."""
    model = contin.Model(
        "impacts", states={"x": -0.5, "v": 0}, parameters={"c": 0.1, "r": 0.8, "w": 2.8},
        equations={"x": "v", "v": "-x - c*v + cos(w*t)"}, forcing={"period": "2*pi/w"},
        events=[{"when": "x", "direction": "up", "set": {"v": "-r*v"}}],
    )  # fmt: skip
    time = 200.0
    found = contin.lyapunov(model, time=time, transient=0.0)
    impacts = (found.exponents.sum() + 0.1) * time / (2.0 * np.log(0.8))
    assert abs(impacts - 100) < 5
    assert abs(impacts - round(impacts)) < 1e-6
    assert found.signs == ["+ -"]


def test_along_a_parameter_each_begins_where_the_last_one_ended():
    model = contin.Model("logistic", kind="map", states={"x": 0.1}, parameters={"a": 3}, equations={"x": "a*x*(1 - x)"})
    found = contin.lyapunov(model, parameter="a", values=np.array([2.5, 3.2, 3.9]), time=2000)
    assert found.exponents.shape == (3, 1)
    expected = [np.log(0.5), 0.5 * np.log(abs(4 + 2 * 3.2 - 3.2**2))]  # multipliers 2 - a, 4 + 2 a - a^2
    np.testing.assert_allclose(found.exponents[:2, 0], expected, atol=1e-6)
    assert found.signs == ["-", "-", "+"]
    drawing = found.plot()
    assert len(drawing.axes[0].lines) == 2  # the exponent, and zero


def test_what_ends_early_or_cannot_be_disturbed_is_said():
    away = contin.Model("away", states={"x": 2}, equations={"x": "x^2"})
    found = contin.lyapunov(away, time=10.0)
    assert np.isnan(found.exponents).all()
    assert "stopped at t" in found.outcomes[0]
    assert found.signs == ["?"]
    clocks = contin.load("oscillators/clocks-and-metronomes")
    together = contin.lyapunov(clocks, "together", time=100.0)
    assert "several events at t" in together.outcomes[0]
    short = contin.lyapunov(lorenz(), time=0.5)
    assert np.isinf(short.errors).all()  # too short to tell
    with pytest.raises(contin.InputError, match="mass matrix"):
        contin.lyapunov(contin.Model("dae", states={"x": 1, "y": 1}, equations={"x": "y", "y": "x - y"}, mass={"y": 0}))
    with pytest.raises(contin.InputError, match="belong together"):
        contin.lyapunov(lorenz(), parameter="r")


def test_of_a_map_logarithms_are_taken_once_and_not_at_every_iterate(monkeypatch):
    """No step length of a map depends on them; what is summed is the same, bit by bit."""
    taken = []
    module = importlib.import_module("contin.exponents.lyapunov")

    def counted(stretches):
        taken.append(stretches.copy())
        return logarithms(stretches)

    monkeypatch.setattr(module, "logarithms", counted)
    found = contin.lyapunov(henon(), time=300)
    [stretches] = taken
    assert stretches.shape == (300, 2)
    singly = np.array([logarithms(row) for row in stretches])
    assert found.exponents.tolist() == (singly.sum(axis=0) / 300.0).tolist()
