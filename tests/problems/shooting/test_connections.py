"""Families and curves by shooting whose period diverges: the connecting orbit that they come to, by other means."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.problems.orbits.test_auto_demos import pendula


def test_a_family_ends_at_the_loop_that_is_known():
    """The cubic leaf x^2 (1 - x) = y^2 is a loop of the origin at m = 0 (Sandstede 1997)."""
    model = Model(
        "leaf", states={"x": 0.6, "y": 0}, parameters={"m": 0.4, "a": -0.25, "b": 1},
        equations={"x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1), settings={"method": "shooting"})
    end = family.ends[1]
    assert end.reason == "homoclinic"
    assert abs(end.data["at"]["m"]) <= end.data["error"] < 1e-7
    assert list(end.data["saddle"].values()) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert [point.label for point in family.points] == ["HOM1"]


@pytest.fixture(scope="module")
def rotations():
    """Of pendula, by shooting: the angles go round, and the speeds hardly change."""
    return contin.continuation(contin.periodic_orbit(pendula(), {}, method="shooting"), "I", (0.0, 1.0))


def test_rotations_are_one_family_from_the_homoclinic_one_on(rotations):
    """Mean torque and friction balance: the mean speed is I/eps, so the period 2 pi eps/I of fast rotations falls."""
    drive, period = rotations.columns["I"], rotations.columns["period"]
    assert np.all(np.diff(drive) > 0.0)
    assert np.all(np.diff(period[1:]) < 0.0)
    assert period[-1] == pytest.approx(2.0 * np.pi * 0.1, rel=1e-3)
    low, high = rotations.ends
    assert (low.reason, high.reason) == ("homoclinic", "bound")
    assert np.sin(low.data["saddle"]["a"]) == pytest.approx(low.data["at"]["I"], abs=1e-9)
    by_collocation = contin.continuation(contin.periodic_orbit(pendula(), {}), "I", (0.0, 1.0))
    assert [p.type for p in rotations.points] == [p.type for p in by_collocation.points]
    for one, other in zip(rotations.points, by_collocation.points, strict=True):
        assert abs(one.z[-1] - other.z[-1]) <= one.error + other.error


@pytest.mark.long
def test_a_curve_of_period_doublings_ends_at_the_homoclinic_orbits_that_it_follows(rotations):
    box = {"I": (0, 3), "eps": (0.05, 3)}
    curve = contin.continuation(rotations["PD1"].locus(("I", "eps")), ("I", "eps"), box)
    (end,) = [end for end in curve.ends if end.reason == "homoclinic"]
    assert np.sin(end.data["saddle"]["a"]) == pytest.approx(end.data["at"]["I"], abs=1e-7)
    assert all(point.residual < 1e-5 for point in curve.points)
