"""Homological equations that another eigenvalue makes singular: no coefficient, and words."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.normalforms.linear import solve

pytestmark = pytest.mark.fast


def test_a_singular_matrix_gives_no_solution_of_rounding_errors():
    matrix = np.array([[1.0, 2.0], [0.5, 1.0 + 2.0**-50]])
    with pytest.raises(np.linalg.LinAlgError, match="resonance"):
        solve(matrix, np.array([1.0, 0.0]))
    assert solve(np.diag([1.0, 1e-15]), np.array([1.0, 1e-15])) == pytest.approx([1.0, 1.0])  # units, no singularity


@pytest.fixture(scope="module")
def circles():
    """The Neimark-Sacker curve of x -> a - x(n-1)^2 - b x(n-2): on it the multipliers have the product -b."""
    model = contin.Model(
        "henon3", kind="map", states={"x": 0.5, "y": 0.5, "z": 0.5}, parameters={"a": 0.0, "b": 0.1},
        equations={"x": "a - y^2 - b*z", "y": "x", "z": "y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"x": 0, "y": 0, "z": 0}), "a", (-0.5, 2))
    return contin.continuation(line["NS1"].locus(("a", "b")), ("a", "b"), {"a": (-2, 4), "b": (-1.5, 1.5)})


def test_a_third_multiplier_of_one_leaves_a_strong_resonance_without_coefficients(circles):
    """At a = 0, b = -1 the multipliers are the three cube roots of 1."""
    (point,) = [p for p in circles.points if p.type == "R3"]
    assert (point.values["a"], point.values["b"]) == pytest.approx((0.0, -1.0), abs=1e-9)
    assert "a" not in point.normal_form
    assert any("R3: its normal form could not be computed" in note for note in circles.notes)


def test_two_tests_that_vanish_at_one_point_are_both_told(circles):
    """At a = 0, b = 1 the multipliers are the cube roots of -1, and the real part of d vanishes, too."""
    (point,) = [p for p in circles.points if p.type == "PDNS"]
    assert (point.values["a"], point.values["b"]) == pytest.approx((0.0, 1.0), abs=1e-9)
    assert not any("without a label" in note for note in circles.notes)
