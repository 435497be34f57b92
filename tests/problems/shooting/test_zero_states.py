"""States that are zero along an orbit, but for rounding and what Newton's method has left of them."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from contin.problems.shooting.segments import Segments

TURNING = {"a": "a - b - a*(a^2 + b^2)", "b": "a + b - b*(a^2 + b^2)"}
FOLD = {"x": "y", "y": "p - x^2 + q*y + x*y"}  # y rests at 0, where p and x^2 cancel


@pytest.fixture(scope="module")
def orbit():
    model = Model(
        "resting", states={"a": 1.0, "b": 0.0, "x": 0.5, "y": 0.0}, parameters={"p": 0.25, "q": -0.3},
        equations={**TURNING, **FOLD},
    )  # fmt: skip
    angle = np.linspace(0, 2 * pi, 201)
    start = np.column_stack([np.cos(angle), np.sin(angle), np.full(201, 0.5), np.zeros(201)])
    return contin.periodic_orbit(model, start, period=2 * pi, method="shooting")


def steps_and_end(orbit, x, y):
    u = orbit.nodes.u.copy()
    u[:, 2], u[:, 3] = x, y
    found = Segments.of(orbit.problem("p"), replace(orbit.nodes, u=u, parameter=0.25).vector())
    return sum(flight.steps for flight in found.flights), found.ends[-1]


@pytest.mark.parametrize("left", [1e-30, 1e-20, 1e-16, 1e-13, 1e-11])
def test_what_is_left_of_a_state_at_zero_takes_no_steps(orbit, left):
    """A tolerance in parts of 1e-20 is below the rounding of p - x^2: 20,000 steps were made, and then others."""
    usual, _ = steps_and_end(orbit, 0.5, 0.0)
    taken, end = steps_and_end(orbit, 0.5 + left, left)
    assert usual < 120
    assert taken <= 1.2 * usual
    assert end == pytest.approx([1, 0, 0.5, 0], abs=1e-11 + 200 * left)  # x and y drift apart by T left and less


def test_a_state_that_is_small_and_no_rounding_keeps_its_relative_accuracy():
    """(x, y) beside the rest, of size 1e-6 and small against nothing that cancels, by the linear equations."""
    model = Model(
        "beside", states={"a": 1.0, "b": 0.0, "y": 1e-6}, parameters={"q": -0.3},
        equations={**TURNING, "y": "q*y"},
    )  # fmt: skip
    angle = np.linspace(0, 2 * pi, 201)
    start = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(201)])
    other = contin.periodic_orbit(model, start, period=2 * pi, method="shooting")
    u = other.nodes.u.copy()
    u[:, 2] = 1e-6
    found = Segments.of(other.problem("q"), replace(other.nodes, u=u, parameter=-0.3).vector())
    time = other.nodes.period / len(u)
    assert found.ends[0][2] == pytest.approx(1e-6 * np.exp(-0.3 * time), rel=1e-11)
