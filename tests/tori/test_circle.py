"""Invariant circles of return maps: a torus in closed form, and its change with a parameter."""

import numpy as np
import pytest

import contin
from contin.api import compiled
from contin.errors import NoSolutionError
from contin.tori import fourier
from contin.tori.circle import Plane, continued, first_circle, returned

TORUS = contin.Model(
    "two rings",
    states={"x": 1, "y": 0, "u": 1.2, "v": 0},
    parameters={"w": 2**0.5, "R": 0.8},
    equations={
        "x": "x*(1 - x^2 - y^2) - y", "y": "y*(1 - x^2 - y^2) + x",
        "u": "u*(R^2 - u^2 - v^2)*(1 + x/2) - w*v", "v": "v*(R^2 - u^2 - v^2)*(1 + x/2) + w*u",
    },
)  # fmt: skip


@pytest.fixture(scope="module")
def circle():
    system = compiled(TORUS)
    p = np.array([2**0.5, 0.8])
    return first_circle(system, Plane(1), p, np.array([1.1, 0.7, 0.1]), count=11, transient=20, points=200)


def test_the_circle_of_two_rings_is_round_and_turns_by_the_ratio_of_the_frequencies(circle):
    assert min(circle.rho % 1.0, -circle.rho % 1.0) == pytest.approx(2**0.5 - 1, abs=1e-9)
    assert np.allclose(circle.values[:, 0], 1.0, atol=1e-8)
    assert np.allclose(np.hypot(circle.values[:, 1], circle.values[:, 2]), 0.8, atol=1e-8)
    assert circle.tail < 1e-7


def test_a_family_follows_the_parameter(circle):
    family = list(continued(circle, 1, 0.5, 0.1))
    assert family[-1].p[1] == pytest.approx(0.5)
    for member in family:
        assert np.allclose(np.hypot(member.values[:, 1], member.values[:, 2]), member.p[1], atol=1e-8)
        assert member.rho == pytest.approx(circle.rho, abs=1e-9)


def test_shifts_are_exact_for_resolved_curves_and_rotations_for_quasiperiodic_points():
    s = fourier.nodes(9)
    curve = lambda s: np.stack([np.cos(2 * np.pi * s), np.sin(6 * np.pi * s)], axis=1)  # noqa: E731
    values, slopes = fourier.shift(9, 0.3)
    assert np.allclose(values @ curve(s), curve(s + 0.3))
    assert np.allclose(slopes @ curve(s), (curve(s + 0.3 + 1e-6) - curve(s + 0.3 - 1e-6)) / 2e-6, atol=1e-6)
    turn = 0.5 * (np.sqrt(5) - 1) / 2
    angles = 2 * np.pi * turn * np.arange(2000)
    points = np.stack([np.cos(angles), 0.4 * np.sin(angles)], axis=1)
    assert abs(fourier.rotation(points)) == pytest.approx(turn, abs=1e-12)  # either way round
    assert np.allclose(fourier.fitted(points, turn, 5)[:, 0], np.cos(2 * np.pi * fourier.nodes(5)))


def test_a_plane_that_is_not_met_is_said():
    with pytest.raises(NoSolutionError, match="return"):
        returned(compiled(TORUS), Plane(0, 5.0), np.array([2**0.5, 0.8]), np.array([0.1, 0.7, 0.1]))
