"""What labelled orbits cost beside their equations: sparse factors, and memory of kernels, are counted."""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from contin.problems.orbits.linearised import bordered
from contin.problems.orbits.march import memory


@pytest.fixture
def made(monkeypatch):
    """The matrices that were factored."""
    seen, factors = [], bordered.factors

    def counted(matrix):
        seen.append(matrix)
        return factors(matrix)

    monkeypatch.setattr(bordered, "factors", counted)
    return seen


def test_the_tangent_at_a_fold_takes_no_sparse_factors(made):
    """r' = r (b + s - s^2), theta' = 1 + s, s = r^2: fold at b = -1/4, where the family moves across b."""
    growth = "b + s - s^2"
    model = Model(
        "bautin", states={"x": 0, "y": 0}, parameters={"b": -1}, definitions={"s": "x^2 + y^2"},
        equations={"x": f"({growth})*x - (1 + s)*y", "y": f"(1 + s)*x + ({growth})*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "b", (-1.0, 1.0))
    start = line["HB1"].switch()
    made.clear()
    family = contin.continuation(start, "b", (-1.0, 1.0))
    (fold,) = family.points
    assert abs(fold.values["b"] + 0.25) <= fold.error < 1e-9
    assert len(made) <= 7  # of its equations and its normal form on two meshes; the tangent took two more
    profile, direction = family.problem.profile(fold.z), family.problem.profile(fold.tangent)
    radius, change = np.hypot(*profile.u.T), np.einsum("tk,tk->t", profile.u, direction.u)
    assert radius == pytest.approx(np.sqrt(0.5), abs=1e-8)
    assert change == pytest.approx(change[0], rel=1e-6)  # ... all orbits are circles
    assert abs(direction.parameter) < 1e-6 * abs(change[0])


def test_a_branch_point_of_orbits_on_a_finer_mesh_is_begun_with_its_borders(made):
    """The unit circle, on which x' = p x + x^2 leaves x = 0 at p = 0 (slope 1: p = -x)."""
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    model = Model(
        "circle", states={"a": 1.0, "b": 0.0, "x": 0.0}, parameters={"p": -0.5},
        equations={"a": "a - b - a*(a^2 + b^2)", "b": "a + b - b*(a^2 + b^2)", "x": "p*x + x^2"},
    )  # fmt: skip
    line = contin.continuation(contin.periodic_orbit(model, points, period=2.0 * np.pi), "p", (-0.5, 0.5))
    (point,) = line.points
    assert point.type == "BPC"
    assert point.normal_form["kind"] == "transcritical"
    assert point.normal_form["slope"] == pytest.approx(1.0, abs=max(point.normal_form["errors"]["slope"], 1e-12))
    assert len(made) <= 8  # nine without


def test_memory_of_two_meshes_in_turn_is_made_once(monkeypatch):
    seen, new = [], memory.new_memory

    def counted(*arguments):
        seen.append(arguments)
        return new(*arguments)

    monkeypatch.setattr(memory, "new_memory", counted)
    monkeypatch.setattr(memory._known, "held", {}, raising=False)
    p = np.zeros(1)
    for intervals in (20, 40, 20, 40, 20):
        memory.memory_of(2, 4, 1, intervals, intervals * 9 + 4, p)
    assert len(seen) == 2
    for intervals in range(5, 5 + 2 * memory.KEPT):
        memory.memory_of(2, 4, 1, intervals, intervals * 9 + 4, p)
    assert len(memory._known.held) == memory.KEPT
