"""Families of conservative systems, unfolded by a parameter that damps: all their orbits exist where it vanishes."""

from __future__ import annotations

import numpy as np
import pytest

from contin import api
from contin.model.model import Model
from contin.problems.orbits.ends.vertical import is_reciprocal


def family(states, equations, parameter="d", start=0.3):
    model = Model("conservative", states=states, parameters={parameter: start}, equations=equations)
    line = api.continuation(api.equilibrium(model), parameter, (-1, 1))
    return api.continuation(line["HB1"].switch(), parameter, (-1, 1))


def is_said_to_be_vertical(branch):
    return any("vertical family" in note and "first integral" in note for note in branch.notes)


def test_predator_and_prey_approach_no_homoclinic_orbit():
    """x - log x + y - log y is conserved at k = 0: orbits linger at the origin, and grow for ever."""
    orbits = family({"x": 1, "y": 1}, {"x": "x - x*y - k*x^2", "y": "x*y - y"}, parameter="k")
    assert [p.type for p in orbits.points] == []
    assert is_said_to_be_vertical(orbits)
    assert orbits.ends[1].reason == "bound"
    assert "all exist at k = 0" in orbits.ends[1].text
    reliable = orbits.columns["period"] < 30.0
    np.testing.assert_allclose(orbits.columns["k"][reliable], 0.0, atol=1e-9)
    for z in orbits.z[5:-3:6]:
        x, y = orbits.problem.profile(z).u[::4].T
        energy = x - np.log(x) + y - np.log(y)
        np.testing.assert_allclose(energy, energy[0], rtol=1e-6)
    assert orbits.columns["x.max"].max() > 25.0


def test_orbits_of_an_undamped_duffing_oscillator_fill_a_homoclinic_loop():
    """x'' = x - x^3: y^2 = x^2 - x^4/2 bounds the orbits, at most at x = sqrt(2), y = 1/sqrt(2)."""
    orbits = family({"x": 1, "y": 0}, {"x": "y", "y": "x - x^3 - d*y"})
    assert is_said_to_be_vertical(orbits)
    end = orbits.ends[1]
    assert end.reason == "homoclinic"
    assert abs(end.data["at"]["d"]) <= end.data["error"] < 1e-9
    np.testing.assert_allclose(list(end.data["saddle"].values()), 0.0, atol=1e-9)
    assert orbits.columns["x.max"][-1] == pytest.approx(np.sqrt(2.0), rel=1e-4)
    assert orbits.columns["y.max"][-1] == pytest.approx(np.sqrt(0.5), rel=1e-4)


def test_orbits_of_an_undamped_pendulum_fill_the_region_between_its_separatrices():
    orbits = family({"x": 0, "y": 0}, {"x": "y", "y": "-sin(x) - d*y"})
    assert is_said_to_be_vertical(orbits)
    end = orbits.ends[1]
    assert end.reason == "heteroclinic"
    assert [s["state"]["x"] for s in end.data["saddles"]] == pytest.approx([-np.pi, np.pi])
    assert orbits.columns["y.max"][-1] == pytest.approx(2.0, rel=1e-4)


def test_orbits_in_a_quartic_well_grow_for_ever():
    """x'' = -x - x^3: T -> 7.4163 / A as A grows (4 int_0^1 dx / sqrt((1 - x^4) / 2))."""
    orbits = family({"x": 0, "y": 0}, {"x": "y", "y": "-x - x^3 - d*y"})
    assert is_said_to_be_vertical(orbits)
    assert orbits.ends[1].reason == "bound"
    assert "without bound" in orbits.ends[1].text
    assert orbits.columns["period"][-1] * orbits.columns["x.max"][-1] == pytest.approx(7.416298709, rel=1e-4)


def test_family_of_an_oscillator_with_friction_is_not_said_to_be_vertical():
    """x'' - mu x' + x^2 x' + x = 0: r^2 = 4 mu."""
    orbits = family({"x": 0, "y": 0}, {"x": "y", "y": "-x + mu*y - x^2*y"}, parameter="mu", start=-0.3)
    assert not is_said_to_be_vertical(orbits)


@pytest.mark.parametrize(
    ("multipliers", "answer"),
    [
        ([1, 1], True), ([1, 1, np.exp(0.3j), np.exp(-0.3j)], True), ([1, 1, 3, 1 / 3], True),
        ([1, 1, 3, 0.5], False), ([1, 1, 0.5], False), ([1, 1, -2, -0.5], True), ([1, 1, np.nan, 0.5], False),
    ],
)  # fmt: skip
def test_multipliers_of_hamiltonian_orbits_come_in_reciprocal_pairs(multipliers, answer):
    assert is_reciprocal(np.array(multipliers, complex)) is answer
