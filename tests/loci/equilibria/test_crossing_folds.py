"""Curves of folds that cross at a cusp: x^3 - b^2 x = a has folds on a = -+ 2 b^3/sqrt(27), and CP where b = 0."""

import numpy as np
import pytest

import contin
from contin.continuation.turning_off import CROSSED, turned_at_once

SNAP = {  # a shallow arch of two bars: no height, no fold
    "name": "arch", "kind": "algebraic", "states": {"w": 0.0}, "parameters": {"P": 0.0, "h": 0.5},
    "equations": {"w": "(1/sqrt(1 + h^2) - 1/sqrt(1 + (h - w)^2))*(w - h) - P"},
}  # fmt: skip


def crossing(slope: float) -> dict:
    """The cubic with a and b that are turned, and x on a slope."""
    x, b, a = f"(x + {slope}*a)", "(b + 0.3*a^2)", "(a + 0.05*b)"
    return {
        "name": "crossing", "states": {"x": 0.6}, "parameters": {"a": 0.0, "b": 0.5},
        "equations": {"x": f"{x}^3 - {b}^2*{x} - {a}"},
    }  # fmt: skip


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("model", [SNAP, crossing(0.0), crossing(0.35)])
def test_a_cusp_at_which_folds_cross_is_within_its_errors_and_has_a_note(model, order):
    model = contin.load({"contin": 1, **model})
    first, second = model.parameters
    branch = contin.continuation(contin.equilibrium(model), first.name, (-1.0, 1.0))
    names = [first.name, second.name][:: 1 - 2 * order]
    curve = contin.continuation(branch["LP1"].locus(), names, dict.fromkeys(names, (-0.6, 0.7)))
    point = curve["CP1"]
    assert set(point.errors) == {*names, *branch.problem.system.state_names}
    assert all(abs(point.values[name]) <= error < 1e-4 for name, error in point.errors.items())
    assert any(CROSSED in note for note in curve.notes)


@pytest.mark.parametrize(("length", "angle", "rows"), [(1e-7, 0.12, [3]), (1e-2, 0.12, []), (1e-7, 1e-3, [])])
def test_a_turn_in_next_to_no_length_is_on_to_another_curve(length, angle, rows):
    angles = np.array([0.0, 1e-5, 2e-5, angle, angle + 1e-5, angle + 2e-5])
    tangents = np.column_stack([np.cos(angles), np.sin(angles)])
    lengths = np.array([0.0, 0.05, 0.02, length, 1e-7, 0.05])
    assert turned_at_once(tangents, lengths) == rows
