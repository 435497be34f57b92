"""Orbits compared whatever their phase: on waves whose distance is known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.continuation.sample import Sample
from contin.lowering import compile_system
from contin.model.model import Model
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile

MODEL = Model("turn", states={"x": 0, "y": 0}, parameters={"p": 0}, equations={"x": "-y", "y": "x"})
PROBLEM = OrbitProblem(compile_system(MODEL), np.zeros(1), 0, np.zeros(2), 4)
TIMES = Profile(4, np.zeros((121, 2)), 1.0, np.full(30, 1 / 30), 0.0).times


def wave(phase, radius=1.0, middle=0.0, period=6.0, parameter=0.0):
    """z of middle + radius (cos, sin) with a second harmonic."""
    angle = 2 * np.pi * (TIMES + phase)
    u = np.column_stack([middle + radius * np.cos(angle), radius * np.sin(angle) + 0.3 * radius * np.cos(2 * angle)])
    return Profile(4, u, period, np.full(30, 1 / 30), parameter).vector()


@given(
    phase=st.floats(0.0, 1.0), radius=st.floats(0.5, 2.0), middle=st.floats(-1.0, 1.0), period=st.floats(4.0, 9.0),
    parameter=st.floats(-1.0, 1.0),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_no_shift_brings_orbits_closer_than_they_are_apart(phase, radius, middle, period, parameter):
    near = wave(0.0)
    scale = PROBLEM.initial_scale(near, (-1.0, 1.0))
    start = Sample(wave(phase, radius, middle, period, parameter), np.ones(near.size), np.zeros(4), 0, np.empty(0))
    shifted = PROBLEM.in_phase(start, near, scale)
    assert PROBLEM.apart(start.z, near, scale) <= np.linalg.norm((shifted.z - near) / scale) + 1e-6


def test_orbits_that_differ_in_phase_alone_are_not_apart():
    near = wave(0.0)
    assert PROBLEM.apart(wave(0.37), near, PROBLEM.initial_scale(near, (-1.0, 1.0))) < 1e-6


@pytest.mark.parametrize("change", [{"radius": 1.4}, {"middle": 0.7}, {"period": 9.0}, {"parameter": 0.5}])
def test_orbits_in_phase_that_differ_in_size_place_period_or_parameter_are_so_far_apart(change):
    """Then nothing is lost: size and place change each state by a multiple of itself or by a constant."""
    near, start = wave(0.0), wave(0.0, **change)
    scale = PROBLEM.initial_scale(near, (-1.0, 1.0))
    assert PROBLEM.apart(start, near, scale) == pytest.approx(np.linalg.norm((start - near) / scale), rel=1e-6)
