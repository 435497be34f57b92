"""Cycles of maps that go to infinity end early (AUTO-07p's demo dd2, a predator-prey map)."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


@pytest.mark.seldom
def test_a_cycle_that_grows_without_bound_ends_where_its_multipliers_have_no_digits_left():
    model = Model(
        "dd2", kind="map", states={"x": 0.5, "y": 0.1}, parameters={"a": 2.5},
        equations={"x": "a*x*(1 - x) - 0.2*x*y", "y": "0.9*y + 0.2*x*y"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model, {"x": 0.6, "y": 0.0}), "a", (0.0, 4.0))
    runaway = None
    for _ in range(3):  # down: the cycles live at a < 1
        doubling = min((p for p in branch.points if p.type == "PD"), key=lambda p: p.values["a"])
        branch = contin.continuation(doubling.switch(), "a", (0.0, 4.0))
        assert branch.notes == ()
        assert branch.effort["steps"] < 1000
        if branch.ends[1].reason == "bound" and np.abs(branch.z[-1]).max() > 1e2:
            runaway = branch
    assert runaway is not None


def test_no_corner_is_seen_where_an_iterate_is_strongly_bent():
    """The doubled cycle of the logistic map beyond a = 3: x = (a + 1 +- sqrt((a + 1)(a - 3)))/(2 a)."""
    model = Model("logistic", kind="map", states={"x": 0.6}, parameters={"a": 2.5}, equations={"x": "a*x*(1 - x)"})
    line = contin.continuation(contin.equilibrium(model), "a", (1.5, 4.0))
    for _ in range(4):
        line = contin.continuation(line["PD1"].switch(), "a", (0.0, 4.0))
        assert line.notes == ()
