"""An oscillator that hits a wall: x'' + 2 z x' + x = F cos(w t), x' -> -r x' at x = s."""

from __future__ import annotations

import math

import numpy as np
import pytest

import contin

W, Z, S, R = 1.9, 0.1, 0.3, 0.8
PERIOD = 2.0 * math.pi / W


def impacts(force: float, w: float, z: float, s: float, r: float) -> contin.Model:
    return contin.Model(
        "impacts",
        states={"x": 0.2, "v": -0.3},
        parameters={"F": {"value": force, "range": [0.5, 2]}, "w": w, "z": z, "s": s, "r": r},
        forcing={"period": "2*pi/w"},
        equations={"x": "v", "v": "F*cos(w*t) - 2*z*v - x"},
        events=[{"when": "x - s", "direction": "up", "set": {"v": "-r*v"}}],
    )


@pytest.fixture(scope="module")
def family() -> contin.Branch:
    orbit = contin.periodic_orbit(impacts(1.0, W, Z, S, R))
    return contin.continuation(orbit, "F", (0.5, 2.0), values={"F": [0.8, 1.2, 1.7]})


@pytest.mark.seldom
def test_every_row_has_the_period_of_the_force(family):
    """The row before the grazing orbit too, where errors of the states grow by the rate of landing, which vanishes."""
    assert abs(family.columns["period"] / PERIOD - 1.0).max() < 2e-9


def test_the_family_ends_at_the_orbit_that_grazes_to_the_stated_error(family):
    """That orbit does not hit the wall: F = s |(1 - w^2) + 2 i z w|."""
    grazes = S * math.hypot(1.0 - W**2, 2.0 * Z * W)
    (end,) = (end for end in family.ends if end.reason == "grazing")
    assert abs(end.data["at"]["F"] - grazes) <= end.data["error"] < 1e-3


@pytest.mark.seldom
def test_one_impact_in_two_periods_ends_at_the_same_orbit_and_every_row_closes():
    """Beside the graze, where the multiplier is 1e5, rows are orbits, and multipliers have Liouville's product.

    Rows there were off by 1e-6 of the period, the last had no orbit, and the family ended `corrector`.
    """
    w, z, s = 2.9, 0.0675, 0.165
    orbit = contin.periodic_orbit(impacts(0.862, w, z, s, 0.765))
    branch = contin.continuation(orbit, "F", (0.2, 1.3), direction="down")
    grazes = s * math.hypot(1.0 - w**2, 2.0 * z * w)
    assert [point.type for point in branch.points] == ["LPC"]
    assert not branch.notes
    assert abs(branch.columns["period"] * w / (4.0 * math.pi) - 1.0).max() < 2e-9
    np.testing.assert_allclose(
        np.prod(branch.eigenvalues, axis=1), 0.765**2 * math.exp(-8.0 * math.pi * z / w), rtol=1e-2
    )
    (end,) = (end for end in branch.ends if end.reason == "grazing")
    assert abs(end.data["at"]["F"] - grazes) <= end.data["error"] < 2e-4


def test_the_product_of_the_multipliers_is_that_of_liouville_with_one_impact(family):
    """det = r^2 exp(-2 z T): the saltation matrix of an impact has the determinant r^2."""
    assert len(family.points) >= 4
    for point in family.points:
        product = complex(math.prod(point.eigenvalues.tolist()))
        assert product == pytest.approx(R**2 * math.exp(-2.0 * Z * PERIOD), rel=1e-9)


def test_a_resonance_against_a_wall_at_rest_has_no_remarks():
    """x'' + x = cos(w t), x' -> -r x' at x = 0: between impacts x = a cos t + b sin t + K cos(w t + c).

    K = 1/(1 - w^2); x(0) = x(T) = 0 gives a = -K cos c, b = a tan(T/2), and v(0) = -r v(T) gives tan c. After every
    impact x is 0 to rounding errors, of which nothing is left a few rows on; that is no other branch.
    """
    model = contin.Model(
        "wall", states={"x": 0.1, "v": 1.0}, parameters={"r": R, "w": 1.9}, forcing={"period": "2*pi/w"},
        equations={"x": "v", "v": "cos(w*t) - x"}, events=[{"when": "x", "direction": "down", "set": {"v": "-r*v"}}],
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "w", (1.5, 2.3))
    assert not branch.notes
    for w, v, x_min in zip(branch.columns["w"], branch.z[:, 1], branch.columns["x.min"], strict=True):
        period, size = 2.0 * math.pi / w, 1.0 / (1.0 - w * w)
        turn = math.tan(period / 2.0) * (1.0 + R * math.cos(period)) - R * math.sin(period)
        phase = math.atan(-turn / (w * (1.0 + R)))
        speed = -size * math.cos(phase) * math.tan(period / 2.0) - w * size * math.sin(phase)
        assert v == pytest.approx(abs(speed), rel=1e-9)
        assert x_min == pytest.approx(0.0, abs=1e-12)
