"""Homoclinic orbits to saddle-nodes: where families end on them, their curves, and the non-central ones at the ends."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.errors import InputError
from contin.model.model import Model

PLANE = ("K", "Z")
BOX = {"K": (4.9, 7.2), "Z": (0.0, 0.3)}


@pytest.fixture(scope="module")
def predators():
    """Scheffer's predator-prey model with immigration, the demo `mtn` of AUTO-07p (its Z is GF)."""
    return Model(
        "predators", states={"X": 1, "Y": 1.5}, parameters={"K": 6, "Z": 0.05},
        definitions={"eaten": "0.4*X/(0.6 + X)", "fish": "Y^2/(Y^2 + 0.25)"},
        equations={"X": "0.5*X*(1 - X/K) - Y*eaten + 0.01*K", "Y": "0.6*eaten*Y - 0.15*Y - Z*fish"},
    )  # fmt: skip


def family_at(model, K):
    return contin.continuation(contin.periodic_orbit(model, {"X": 1, "Y": 1.5}, {"K": K}), "Z", (0.0, 0.3))


@pytest.fixture(scope="module")
def central(predators):
    family = family_at(predators, 6.0)
    end = family.ends[1]
    assert end.reason == "homoclinic"
    assert end.data["saddle_node"]
    assert end.data["at"]["Z"] == pytest.approx(0.06729762, abs=5e-9)  # AUTO's mtn.f90
    assert end.data["saddle"] == pytest.approx({"X": 5.738626, "Y": 0.5108401}, abs=1e-6)
    return contin.continuation(family["HOM1"].locus(PLANE), PLANE, BOX)


@pytest.mark.seldom
def test_central_orbits_lie_on_the_curve_of_folds(central):
    """f = 0 and det f_u = 0, by hand."""
    assert (central.locus, central.kind) == ("HOM", "locus")
    assert central.columns["saddle_node"].all()
    K, Z, X, Y = (central.columns[name] for name in ("K", "Z", "X.saddle", "Y.saddle"))
    eaten, slope = 0.4 * X / (0.6 + X), 0.24 / (0.6 + X) ** 2
    fish, bend = Y**2 / (Y**2 + 0.25), 0.5 * Y / (Y**2 + 0.25) ** 2
    np.testing.assert_allclose(0.5 * X * (1 - X / K) - Y * eaten + 0.01 * K, 0, atol=1e-9)
    np.testing.assert_allclose(0.6 * eaten * Y - 0.15 * Y - Z * fish, 0, atol=1e-9)
    determinant = (0.5 - X / K - Y * slope) * (0.6 * eaten - 0.15 - Z * bend) + eaten * 0.6 * slope * Y
    np.testing.assert_allclose(determinant, 0, atol=1e-9)


def test_central_orbits_end_at_the_non_central_ones_of_auto(central):
    """AUTO-07p's manual, demo mtn: (6.610459, 0.06932482) at label 15; less exactly, (5.180317, 0.06385503)."""
    assert [p.type for p in central.points] == ["NCH", "NCH"]
    assert [end.reason for end in central.ends] == ["saddle-node", "saddle-node"]
    assert [p.index for p in central.points] == [0, len(central) - 1]
    low, high = central.points
    assert (high.values["K"], high.values["Z"]) == pytest.approx((6.610459, 0.06932482), rel=2e-7)
    assert (low.values["K"], low.values["Z"]) == pytest.approx((5.180317, 0.06385503), rel=3e-6)


@pytest.mark.seldom
def test_the_curve_of_saddle_loops_comes_to_the_same_point(predators, central):
    loops = contin.continuation(family_at(predators, 6.7)["HOM1"].locus(PLANE), PLANE, BOX | {"K": (4.9, 6.8)})
    assert [p.type for p in loops.points] == ["NCH"]
    assert "saddle_node" not in loops.columns
    point, other = loops["NCH1"], central["NCH2"]
    for name in PLANE:
        assert point.values[name] == pytest.approx(other.values[name], abs=1e-7)
    assert {end.reason for end in loops.ends} == {"saddle-node", "bound"}


@pytest.mark.parametrize(("K", "central"), [(6.60, True), (6.62, False)])
def test_beside_the_non_central_orbit_families_end_at_the_one_or_the_other(predators, K, central):
    """NCH is at K = 6.610459: the loops of the saddle at K = 6.62 exist 2.4e-8 beyond the fold."""
    end = family_at(predators, K).ends[1]
    assert end.reason == "homoclinic"
    assert end.data.get("saddle_node", False) is central
    values = np.sort(np.real(end.data["eigenvalues"]))
    assert values[0] < -0.4
    assert (abs(values[1]) < 1e-9) if central else (1e-6 < values[1] < 1e-2)


def test_from_the_non_central_orbit_the_curve_of_saddle_loops_begins(central):
    """AUTO's curve from D1 passes K = 7.114523, Z = 0.07081751 (label 11, as coarse as D1 itself)."""
    (seed,) = central["NCH2"].locus(PLANE)
    loops = contin.continuation(seed, PLANE, BOX)
    assert loops.parent.label == "NCH2"
    assert [end.reason for end in loops.ends] == ["start", "bound"]
    assert loops.points == ()
    assert np.all(loops.columns["K"][1:] > central["NCH2"].values["K"])
    assert np.interp(7.114523, loops.columns["K"], loops.columns["Z"]) == pytest.approx(0.07081751, abs=2e-6)


def josephson_damping():
    """g where at I = 1 the orbit that leaves the saddle-node comes back along its strong direction.

    phi' = w, w' = 1 - sin phi - g w as dw/dphi, forwards from the centre manifold w = d^2/(2 g) + O(d^3) and
    backwards from the strong one, w = -g d + O(d^2), over the turn from phi = pi/2 to 5 pi/2.
    """

    def passing(start, w, finish, g):
        path = solve_ivp(
            lambda phi, w: (1 - np.sin(phi)) / w - g, (start, finish), [w], "DOP853", rtol=1e-11, atol=1e-13
        )
        return float(path.y[0, -1])

    def gap(g):
        d, e = 0.02, 1e-5
        on_centre = (d**2 / 2) / g - (d**3 / 2) / g**3  # w = h(d): h' h = d^2/2 - g h
        return passing(pi / 2 + d, on_centre, pi, g) - passing(5 * pi / 2 - e, g * e, pi, g)

    return brentq(gap, 1.1, 1.3, xtol=1e-10)


@pytest.fixture(scope="module")
def josephson():
    """A Josephson junction (a pendulum with torque): rotations end at I = 1 for large damping, below it for small."""
    return Model(
        "josephson", states={"phi": {"value": 0, "period": "2*pi"}, "w": 3}, parameters={"I": 1.5, "g": 0.5},
        equations={"phi": "w", "w": "I - sin(phi) - g*w"},
    )  # fmt: skip


@pytest.mark.seldom
def test_rotations_have_a_curve_of_homoclinic_orbits_too(josephson):
    """I = 4 g/pi + O(g^2) by Melnikov's method; at I = 1 it ends where the saddle-node's loop is non-central."""
    family = contin.continuation(contin.periodic_orbit(josephson), "I", (0.0, 2.0))
    plane, box = ("I", "g"), {"I": (0.0, 1.5), "g": (0.01, 1.5)}
    loops = contin.continuation(family["HOM1"].locus(plane), plane, box)
    assert loops.columns["I"][0] == pytest.approx(4 * 0.01 / pi, rel=1e-3)
    point = loops["NCH1"]
    assert point.values["I"] == pytest.approx(1, abs=1e-9)
    assert point.values["g"] == pytest.approx(josephson_damping(), abs=2e-7)
    (seed,) = point.locus(("g", "I"))
    central = contin.continuation(seed, ("g", "I"), box)
    np.testing.assert_allclose(central.columns["I"], 1, atol=1e-9)
    assert np.all(np.diff(central.columns["g"]) > 0)
    assert central.columns["g"][[0, -1]] == pytest.approx([point.values["g"], 1.5], abs=1e-6)


def test_the_other_curve_varies_the_same_parameters(central, predators):
    with pytest.raises(InputError, match="varies the same two parameters, K, Z"):
        central["NCH1"].locus(("K", "X"))
