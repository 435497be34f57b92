"""Sizes of states on orbits are their own in any units: those of states that drive others, and that nothing drives."""

import json

import numpy as np
import pytest

from contin.lowering.system import compile_system
from contin.model.yaml_loader import load_model_text
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile, node_times

H = np.full(10, 0.1)


def problem(units, coupling=1.0):
    """A clock (a, b) drives x (coupling 1), which is not fed back; two further states are zero."""
    a, b, x, y, z = (f"({name}/{float(unit)!r})" for name, unit in zip("abxyz", units, strict=True))
    rates = (
        f"{a}*(1 - {a}^2 - {b}^2) - {b}", f"{b}*(1 - {a}^2 - {b}^2) + {a}", f"mu - {x} + {coupling}*{a}*{b}",
        f"-{y} + {z}", f"-2*{z}",
    )  # fmt: skip
    equations = {n: f"{float(u)!r}*({rate})" for n, u, rate in zip("abxyz", units, rates, strict=True)}
    model = {
        "contin": 1, "name": "clock", "states": dict.fromkeys("abxyz", 0), "parameters": {"mu": 0.5},
        "equations": equations,
    }  # fmt: skip
    return OrbitProblem(compile_system(load_model_text(json.dumps(model))), np.array([0.5]), 0, np.zeros(5))


def sizes(units, zero, coupling=1.0):
    t = 2 * np.pi * node_times(H, 4)
    x = 0.5 + coupling * (0.1 * np.sin(2 * t) - 0.2 * np.cos(2 * t))
    u = np.column_stack([np.cos(t), np.sin(t), x, np.full_like(t, zero), np.full_like(t, zero)]) * units
    return problem(units, coupling).state_sizes(Profile(4, u, 2 * np.pi, H, 0.5))


@pytest.mark.parametrize("small", [2.0**-20, 2.0**-30])
def test_a_clock_in_small_units_has_its_own_size(small):
    """As large as the state that it drives was said: 2e11 times what it is, and Newton's method failed."""
    units = np.array([small, small, 1.0 / small, 1.0, 1.0])
    np.testing.assert_allclose(sizes(units, 0.0)[:3], sizes(np.ones(5), 0.0)[:3] * units[:3], rtol=1e-12)


def test_states_that_are_zero_but_for_rounding_still_take_the_others_sizes():
    assert np.all(sizes(np.ones(5), 1e-19)[3:] == sizes(np.ones(5), 1e-19).max())
