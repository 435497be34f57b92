"""Period doubling and Neimark-Sacker points of maps, hidden by changes of coordinates and in closed form."""

import numpy as np
import pytest

from contin.normalforms.maps import flip_predictor, neimark_sacker, period_doubling

from .formulas import taylor_jet
from .polynomials import hide, rotation_field
from .test_hopf import length
from .test_static import residual, signed

UNITS = [None, [1e5, 1.0, 1e-5], [1e-4, 1e2, 1.0]]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(3))
def test_flip_coefficient_survives_a_change_of_coordinates_and_units(seed, units):
    rng = np.random.default_rng(seed)
    c = rng.normal()
    jet, T = hide([{(1,): -1.0, (3,): c}], [0.4, -1.7], rng, 3, kind="map", units=units)
    form = period_doubling(jet).coefficients
    assert form["c"] == pytest.approx(c / signed(T[:, 0]) ** 2, rel=1e-6)
    assert form["criticality"] == ("supercritical" if c > 0 else "subcritical")


def test_logistic_map_doubles_supercritically():
    # x -> r x (1 - x) at r = 3, x = 2/3: f'' = -2 r, f''' = 0, c = (f'')^2/4 + f'''/6 = 9
    jet = taylor_jet(["x"], ["r"], ["r*x*(1 - x)"], {"x": 2 / 3, "r": 3}, kind="map")
    form = period_doubling(jet).coefficients
    assert form["c"] == pytest.approx(9.0, rel=1e-12)
    assert form["criticality"] == "supercritical"
    doubled = flip_predictor(jet)
    # exact: x = (r + 1 +- sqrt((r - 3)(r + 1)))/(2 r), so (x1 - x2)^2/4 = (r - 3)(r + 1)/(4 r^2) = (r - 3)/9 + ...
    assert doubled.p2 == pytest.approx(9.0, rel=1e-12)
    s = 1e-3
    r = 3 + doubled.parameter_shift(s)
    exact = (r + 1 + np.array([1, -1]) * np.sqrt((r - 3) * (r + 1))) / (2 * r)
    np.testing.assert_allclose(2 / 3 + np.array(doubled.points(s))[:, 0], exact, atol=30 * s**3)


def test_predicted_doubled_orbit_maps_onto_itself_to_third_order():
    rng = np.random.default_rng(4)
    jet, _ = hide([{(1, 0): -1.0, (1, 1): 0.8, (3, 0): 0.5}], [0.4, -1.7], rng, 3, parameters=1, kind="map")
    doubled = flip_predictor(jet)
    sizes, misses = 1e-2 / 2.0 ** np.arange(4), []
    for s in sizes:
        a, b = doubled.points(s)
        misses.append(np.linalg.norm(residual(jet, np.append(a, doubled.parameter_shift(s))) - b))
    assert np.polyfit(np.log(sizes), np.log(misses), 1)[0] == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("seed", range(3))
def test_neimark_sacker_coefficient_survives_a_change_of_coordinates_and_units(seed, units):
    rng = np.random.default_rng(seed)
    theta, d = 1.9, complex(*rng.normal(size=2))
    value = np.exp(1j * theta)
    jet, T = hide(rotation_field(value, {1: value * d}), [0.4], rng, 3, kind="map", units=units)
    form = neimark_sacker(jet).coefficients
    assert form["theta"] == pytest.approx(theta, rel=1e-12)
    assert complex(*form["d"]) == pytest.approx(d / length(T) ** 2, rel=1e-6)
    assert form["criticality"] == ("supercritical" if d.real < 0 else "subcritical")
    assert "resonance" not in form


@pytest.mark.seldom
def test_coefficient_of_the_delayed_logistic_map_is_the_measured_decay_of_its_orbits():
    # x -> r x (1 - y), y -> x at r = 2, theta = pi/3 (Kuznetsov, Elements, 3rd ed., sec. 4.7)
    jet = taylor_jet(["x", "y"], ["r"], ["r*x*(1 - y)", "x"], {"x": 0.5, "y": 0.5, "r": 2}, kind="map")
    form = neimark_sacker(jet).coefficients
    assert form["theta"] == pytest.approx(np.pi / 3, rel=1e-12)
    assert form["criticality"] == "supercritical"
    assert measured_contraction(jet) == pytest.approx(form["d"][0], rel=2e-3)


def measured_contraction(jet):
    """Re d from the decay of orbits: r_n^-2 grows by -2 Re d a step on average (a second, independent method)."""
    q = neimark_sacker(jet).vectors["q"]
    p = neimark_sacker(jet).vectors["p"]
    steps = 30000
    u = 2 * (0.02 * q).real
    sizes = []
    for i in range(steps):
        if i % (steps // 6) < 6000 and i // (steps // 6) in (0, 5):
            sizes.append((i, abs(np.vdot(p, u)) ** -2))
        u = residual(jet, u if jet.parameters == 0 else np.append(u, np.zeros(jet.parameters)))
    first = np.mean([s for s in sizes if s[0] < steps // 6], axis=0)
    last = np.mean([s for s in sizes if s[0] >= steps // 6], axis=0)
    return -(last[1] - first[1]) / (last[0] - first[0]) / 2
