"""Trajectories against closed forms."""

import numpy as np
import pytest

from contin.errors import InputError, NotFiniteError
from contin.lowering import compile_system
from contin.model.model import Model
from contin.simulate.trajectory import Section, integrate


@pytest.fixture(scope="module")
def oscillator():
    model = Model("oscillator", states={"x": 1, "v": 0}, parameters={"w": 2}, equations={"x": "v", "v": "-w^2*x"})
    return compile_system(model)


def test_samples_of_an_oscillator_follow_the_cosine_to_the_tolerance(oscillator):
    t = np.linspace(0.0, 20.0, 137)
    path = integrate(oscillator, np.array([1.0, 0.0]), np.array([2.0]), 20.0, times=t)
    np.testing.assert_allclose(path.u[:, 0], np.cos(2 * t), atol=2e-8)
    np.testing.assert_allclose(path.u[:, 1], -2 * np.sin(2 * t), atol=4e-8)


def test_a_tighter_tolerance_gives_a_smaller_error_at_the_rate_of_order_eight(oscillator):
    errors, steps = [], []
    for rtol in (1e-6, 1e-8, 1e-10, 1e-12):
        path = integrate(oscillator, np.array([1.0, 0.0]), np.array([2.0]), 10.0, rtol=rtol, atol=rtol)
        errors.append(abs(path.end[0] - np.cos(20.0)))
        steps.append(path.steps)
    slope = np.polyfit(np.log(steps), np.log(np.maximum(errors, 1e-16)), 1)[0]
    assert -11.0 < slope < -6.0
    assert steps[2] < 120  # effort: measured 66


def test_crossings_of_a_section_come_once_a_period_in_one_direction_and_twice_in_both(oscillator):
    p = np.array([2.0])
    up = integrate(oscillator, np.array([1.0, 0.0]), p, 100.0, section=Section(np.array([1.0, 0.0]), 0.0, 1), events=5)
    np.testing.assert_allclose(up.event_times, 0.75 * np.pi + np.pi * np.arange(5), rtol=1e-9)
    both = integrate(
        oscillator, np.array([1.0, 0.0]), p, 100.0, section=Section(np.array([1.0, 0.0]), 0.0, 0), events=6
    )
    np.testing.assert_allclose(both.event_times, 0.25 * np.pi + 0.5 * np.pi * np.arange(6), rtol=1e-9)
    assert both.end_time < 10.0  # it stops there


def test_variations_are_the_derivative_of_the_flow_by_its_start():
    model = Model("logistic", states={"x": 0.1}, parameters={"r": 1.5}, equations={"x": "r*x*(1 - x)"})
    times = np.array([1.0, 2.0])
    system, u, p = compile_system(model), np.array([0.1]), np.array([1.5])
    path = integrate(system, u, p, 2.0, times=times, variations=np.eye(1))
    growth = np.exp(1.5 * times)
    np.testing.assert_allclose(path.variations[:, 0, 0], growth / (1 + 0.1 * (growth - 1)) ** 2, rtol=1e-9)


def test_a_solution_that_escapes_is_said_to(oscillator):
    model = Model("blow-up", states={"x": 1}, parameters={"a": 1}, equations={"x": "a*x^2"})
    with pytest.raises(NotFiniteError, match=r"trajectory stops at t = (1|0\.99)"):
        integrate(compile_system(model), np.array([1.0]), np.array([1.0]), 2.0)
    with pytest.raises(InputError, match="duration must be positive"):
        integrate(oscillator, np.array([1.0, 0.0]), np.array([2.0]), 0.0)
