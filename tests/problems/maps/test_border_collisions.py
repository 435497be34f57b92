"""Cycles of piecewise maps go on where one of their points meets a switching surface, beside closed forms."""

import numpy as np
import pytest

import contin
from contin.model.model import Model

B = 0.3


@pytest.fixture(scope="module")
def lozi():
    """At a = 1 - b all of an interval has period 2; it ends at x = 0, from where a cycle with x < 0 < y goes on."""
    model = Model(
        "lozi", kind="map", states={"x": 0.4, "y": 0.1}, parameters={"a": 0.3, "b": B},
        equations={"x": "1 - a*abs(x) + y", "y": "b*x"},
    )  # fmt: skip
    return contin.diagram(model, "a", (-0.5, 1.7))


def test_the_doubled_cycle_leaves_its_vertical_branch_at_the_corner(lozi):
    doubled = lozi["start/PD1"]
    assert [end.reason for end in doubled.ends] == ["start", "bound"]
    columns = doubled.columns
    a, beyond = columns["a"], columns["a"] > 1.0 - B + 1e-6
    low, high = (1 - B - a) / ((1 - B) ** 2 + a * a), (1 - B + a) / ((1 - B) ** 2 + a * a)
    np.testing.assert_allclose(columns["x.min"][beyond], low[beyond], atol=1e-10)
    np.testing.assert_allclose(columns["x.max"][beyond], high[beyond], atol=1e-10)


def test_its_doubling_is_where_trace_and_determinant_say_and_nothing_else_is_labelled(lozi):
    """-a^2 + 2 b, b^2: a multiplier is -1 at a = 1 + b; the next cycle leaves a vertical branch again: no fold."""
    points = [(branch.name, point.type, point.values["a"]) for branch in lozi for point in branch.points]
    assert [(name, type_) for name, type_, _ in points] == [("start", "PD"), ("start/PD1", "PD")]
    assert [a for _, _, a in points] == pytest.approx([1 - B, 1 + B], abs=1e-9)
    assert lozi["start/PD1/PD1"].ends[1].reason == "bound"


def stepped(jump: float, p: float, x: float) -> Model:
    """x -> p + x/2, less `jump` where x > 0."""
    return Model(
        "stepped", kind="map", states={"x": x}, parameters={"p": p},
        equations={"x": f"p + x/2 - ({jump} if x > 0 else 0)"},
    )  # fmt: skip


def test_both_points_of_a_cycle_of_a_map_that_jumps_end_it_at_the_jump():
    """x1 = p - 1 + x2/2 < 0 < x2 = p + x1/2 with the jump 1: x2 = (2 p - 2/3), x1 = (2 p - 4/3), for 1/3 < p < 2/3."""
    start = contin.equilibrium(stepped(1.0, 0.5, -0.3), period=2)
    branch = contin.continuation(start, "p", (0.0, 1.0))
    assert [end.reason for end in branch.ends] == ["surface", "surface"]
    assert [point.type for point in branch.points] == ["BE", "BE"]
    for point, at in zip(branch.points, (1 / 3, 2 / 3), strict=True):
        assert abs(point.values["p"] - at) <= max(point.error, 1e-15)
        assert point.normal_form["kind"] == "border collision"
        assert point.eigenvalues == pytest.approx([0.25])
    np.testing.assert_allclose(branch.columns["x.2"], 2.0 * branch.columns["p"] - 2 / 3, atol=1e-9)


def test_a_tiny_jump_ends_a_cycle_too():
    """The larger point of the 2-cycle of r x (1 - x) is (r + 1 + sqrt((r - 3)(r + 1)))/(2 r)."""
    model = Model(
        "logistic", kind="map", states={"x": 0.5}, parameters={"r": 3.15},
        equations={"x": "r*x*(1 - x) - (1e-7 if x > 0.8 else 0)"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model, period=2), "r", (3.1, 3.3))
    (point,) = branch.points
    r = point.values["r"]
    assert branch.ends[1].reason == "surface"
    assert (r + 1.0 + np.sqrt((r - 3.0) * (r + 1.0))) / (2.0 * r) == pytest.approx(0.8, abs=1e-12)


@pytest.mark.parametrize("jump", [1e-7, 0.3, -0.3])
def test_a_fixed_point_that_starts_on_the_jump_does_not_pass_it(jump):
    branch = contin.continuation(contin.equilibrium(stepped(jump, 0.0, 0.0)), "p", (-1.0, 1.0))
    assert [end.reason for end in branch.ends] == ["bound", "surface"]
    (point,) = branch.points
    assert (point.type, point.values["p"], point.normal_form["side"]) == ("BE", 0.0, "x < 0")
    np.testing.assert_allclose(branch.columns["x"], 2.0 * branch.columns["p"], atol=1e-9)
