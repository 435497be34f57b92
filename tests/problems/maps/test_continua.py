"""Piecewise linear maps: where a cycle doubles, cycles of twice its length fill a line at one parameter."""

from __future__ import annotations

import numpy as np
import pytest

import contin


def test_doubled_cycles_of_lozis_map_leave_their_continuum_without_changes_that_nothing_explains():
    """x' = 1 - a |x| + y, y' = b x doubles at a = 1 - b. Cycles of two points are stable to a = 1 + b, those of four
    points are there from that value on."""
    b = 0.3
    model = contin.Model(
        "lozi", kind="map", states={"x": 0.5, "y": 0.1}, parameters={"a": 0.2, "b": b},
        equations={"x": "1 - a*abs(x) + y", "y": "b*x"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (0.05, 1.8))
    two = contin.continuation(line["PD1"].switch(), "a", (0.05, 1.8))
    assert line["PD1"].values["a"] == pytest.approx(1.0 - b, abs=1e-13)
    assert [point.label for point in two.points] == ["PD1"]
    assert two["PD1"].values["a"] == pytest.approx(1.0 + b, abs=1e-13)
    assert two["PD1"].normal_form["criticality"] == "degenerate"
    a = two.columns["a"]
    np.testing.assert_array_equal(two.columns["unstable"], a > 1.0 + b + 1e-9)
    assert not any("told apart" in note or "without a label" in note or "LP" in note for note in two.notes)
    beyond = a > 1.0 - b + 1e-9  # x1 > 0 > x2: x1 + a x1 = 1 + b x2, x2 - a x2 = 1 + b x1
    x2 = (1.0 - b - a) / ((1.0 - b) ** 2 + a * a)
    np.testing.assert_allclose(two.columns["x.min"][beyond], x2[beyond], rtol=1e-10)
