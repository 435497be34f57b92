"""Starts from samples that lead to a solution far from them say so; starts near them say nothing."""

import numpy as np
import pytest

import contin

BRATU = {
    "name": "bratu", "kind": "bvp", "time": {"name": "x"}, "states": {"u": 0, "v": 0}, "parameters": {"lam": 1.0},
    "equations": {"u": "v", "v": "-lam*exp(u)"}, "conditions": ["u(start) = 0", "u(end) = 0"],
}  # fmt: skip
KDV = {
    "name": "kdv", "states": {"q": 0, "p": 0, "r": 0, "s": 0}, "parameters": {"b": 3.0, "a": 3.0},
    "equations": {"q": "r", "p": "3/2*q^2 + a*q - r^2/2", "r": "15/2*s", "s": "-p + b*r - q*r"},
}  # fmt: skip
REVERSOR = {"r": "-r", "p": "-p"}
FAR = "the solution that the samples led to is not near them"


@pytest.mark.parametrize(("height", "far"), [(0.14, False), (1.0, True), (4.0, False)])
def test_boundary_value_problems(height, far):
    """Bratu's problem at lam = 1 has two solutions, of heights 0.1405 and 4.091."""
    x = np.linspace(0.0, 1.0, 101)
    arch = np.column_stack([4.0 * height * x * (1.0 - x), 4.0 * height * (1.0 - 2.0 * x)])
    start = contin.boundary_problem(contin.load(BRATU), samples=(x, arch))
    branch = contin.continuation(start, "lam", (0.5, 2), settings={"steps": 1})
    assert [note.startswith(FAR) for note in branch.notes] == ([True] if far else [])


@pytest.mark.parametrize(("size", "shift", "far"), [(1.0, 0.0, False), (1.0, 0.37, False), (2.5, 0.0, True)])
def test_orbits(size, shift, far):
    """x'' = -x at any amplitude, bent to the circle of radius 1; samples may begin anywhere on it."""
    parts = {
        "name": "circle", "states": {"x": 1, "y": 0}, "parameters": {"a": 1.0},
        "equations": {"x": "x*(a - x^2 - y^2) - y", "y": "y*(a - x^2 - y^2) + x"},
    }  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    turn = size * np.column_stack([np.cos(t + shift), np.sin(t + shift)])
    orbit = contin.periodic_orbit(contin.load(parts), turn, times=t)
    branch = contin.continuation(orbit, "a", (0.9, 1.1), settings={"steps": 1})
    assert [note.startswith(FAR) for note in branch.notes] == ([True] if far else [])


def test_states_that_samples_hold_at_zero():
    """z is driven by what collocation leaves of r - 1: 2e-10 of noise is no variation that samples have not."""
    rate = "(1 - x^2 - y^2)"
    model = contin.Model(
        "circle", states={"x": 1, "y": 0, "z": 0}, parameters={"a": 1.0},
        equations={"x": f"x*{rate} - 2*y", "y": f"y*{rate} + 2*x", "z": f"a*z/2 - {rate}"},
    )  # fmt: skip
    t = np.linspace(0.0, np.pi, 41)
    orbit = contin.periodic_orbit(model, np.column_stack([np.cos(2 * t), np.sin(2 * t), 0 * t]), times=t)
    branch = contin.continuation(orbit, "a", (0.9, 1.1), settings={"steps": 1})
    assert not [note for note in branch.notes if note.startswith(FAR)]


@pytest.mark.parametrize("apart", [0.0, 12.0])
@pytest.mark.seldom
def test_two_pulses_that_lead_to_one(apart):
    model = contin.load(KDV)
    alone = contin.connection(model, {"q": 0}, reversor=REVERSOR)
    known = contin.continuation(alone, "b", (2.1, 4), settings={"steps": 1})
    z = known.z[known.start_row]
    one = known.problem.profile(z[np.isfinite(z)])
    half = 0.5 * one.period

    def pulse(x):
        inside = np.abs(x) <= half
        return np.column_stack([inside * np.interp(x + half, one.times * one.period, u) for u in one.u.T])

    t = np.linspace(0.0, 2.0 * half + apart, 801)
    samples = pulse(t - half) if apart == 0.0 else pulse(t - half) + pulse(t - half - apart)
    start = contin.connection(model, {"q": 0}, samples=(t, samples), reversor=REVERSOR)
    branch = contin.continuation(start, "b", (2.1, 4), settings={"steps": 1})
    assert [note.startswith(FAR) for note in branch.notes] == ([True] if apart else [])
