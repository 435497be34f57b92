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
