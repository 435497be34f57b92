"""The kind of a branch point of orbits is decided by its coefficient and the error of that, not by a small number."""

import numpy as np
import pytest

import contin
from contin.model.model import Model

CIRCLE = {"a": "a - b - a*(a^2 + b^2)", "b": "a + b - b*(a^2 + b^2)"}


def crossing(growth: str):
    """The unit circle, on which x' = growth leaves x = 0 at p = 0."""
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    model = Model(
        "circle", states={"a": 1.0, "b": 0.0, "x": 0.0}, parameters={"p": -0.5}, equations=CIRCLE | {"x": growth}
    )
    orbit = contin.periodic_orbit(model, points, period=2.0 * np.pi)
    (point,) = contin.continuation(orbit, "p", (-1.0, 1.0)).points
    assert point.type == "BPC"
    return point.normal_form


@pytest.mark.parametrize("slope", [1.0, 1e-4, 1e-7, 1e-9])
def test_a_family_whose_parameter_moves_ever_so_slowly_is_no_pitchfork(slope):
    """x' = p x + slope x^2 (1 + a/2) - x^3: averaged over the circle, p = -slope x + x^2."""
    form = crossing(f"p*x + {slope!r}*x^2*(1 + a/2) - x^3")
    assert form["kind"] == "transcritical"
    assert form["slope"] == pytest.approx(slope, abs=form["errors"]["slope"])
    assert form["errors"]["slope"] < 1e-10 + 1e-8 * slope


def test_a_pitchfork_without_a_declared_symmetry_has_a_slope_that_is_zero_to_its_error():
    form = crossing("p*x - x^3*(1 + a/2)")
    assert form["kind"] == "pitchfork"
    assert form["slope"] <= form["errors"]["slope"] < 1e-10


def test_where_the_multiplier_only_touches_1_the_point_is_degenerate_or_no_label():
    """x' = p^2 x - x^3: no exchange of stability, so that nothing is stated."""
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    model = Model(
        "touch", states={"a": 1.0, "b": 0.0, "x": 0.0}, parameters={"p": -0.5}, equations=CIRCLE | {"x": "-p^2*x - x^3"}
    )
    branch = contin.continuation(contin.periodic_orbit(model, points, period=2.0 * np.pi), "p", (-1.0, 1.0))
    assert all(point.normal_form.get("kind", "degenerate") == "degenerate" for point in branch.points)
