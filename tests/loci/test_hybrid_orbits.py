"""Curves in two parameters of special orbits with jumps against closed forms, and their points of codimension two."""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from contin.store.results import save_branches
from tests.problems.hybrid.test_orbits import FOLD, TABLE

HENON = Model(
    "henon", states={"s": 0.0, "x": 0.3, "y": 0.1}, parameters={"a": 0.2, "b": -0.9},
    equations={"s": "1", "x": "0", "y": "0"},
    events=[{"when": "s - 1", "direction": "up", "set": {"s": 0, "x": "1 - a*x^2 + y", "y": "b*x"}}],
)  # fmt: skip
HOOP = Model(
    "hoop", states={"s": 0.0, "x": 0.6}, parameters={"a": 2.0, "b": 0.0, "h": 0.7}, equations={"s": "1", "x": "0"},
    events=[
        {"when": "s - 1", "direction": "up", "set": {"s": 0, "x": "a*x*(1 - x) + b"}},
        {"when": "x*sin(pi*s) - h", "direction": "up", "set": {"x": "x/2"}},
    ],
)  # fmt: skip

LONG = {"step": 0.1, "max_step": 0.25}  # of the range: curves that are smooth are looked at by their closed forms


@pytest.fixture(scope="module")
def henon():
    return contin.continuation(contin.periodic_orbit(HENON), "a", (-1.0, 3.0))


@pytest.mark.seldom
def test_folds_of_bouncing_balls_lie_on_their_curve():
    """A w = (1 - r)/(1 + r) T/2 of every restitution r, with multipliers whose product is r^2."""
    start = contin.periodic_orbit(TABLE, {"x": 0.01, "v": 0.5}, {"A": 1.05 * FOLD})
    line = contin.continuation(start, "A", (0.02, 0.03))
    curve = contin.continuation(line["LPC1"].locus(), ("A", "r"), {"A": (0.005, 0.2), "r": (0.48, 0.52)}, settings=LONG)
    A, r = curve.columns["A"], curve.columns["r"]
    np.testing.assert_allclose(A, (1.0 - r) / (1.0 + r) / (4.0 * np.pi), rtol=1e-10)
    np.testing.assert_allclose(curve.columns["period"], 1.0, rtol=1e-9)
    assert (curve.locus, {end.reason for end in curve.ends}) == ("LPC", {"bound"})
    assert {r.min(), r.max()} == {0.48, 0.52}


@pytest.mark.long
def test_curves_of_the_henon_map_of_jumps_and_the_resonance_between(henon):
    """det = -b, trace = -2 a x: folds at a = -(1 - b)^2/4, doublings at a = 3 (1 - b)^2/4; resonances at b = -1."""
    ranges = {"a": (-4.0, 4.0), "b": (-1.05, -0.85)}
    folds = contin.continuation(henon["LPC1"].locus(), ("a", "b"), ranges)
    a, b = folds.columns["a"], folds.columns["b"]
    np.testing.assert_allclose(a, -((1.0 - b) ** 2) / 4.0, atol=1e-9)
    assert [point.type for point in folds.points] == ["R1"]
    assert folds["R11"].values["b"] == pytest.approx(-1.0, abs=1e-8)
    flips = contin.continuation(henon["PD1"].locus(), ("a", "b"), ranges)
    a, b = flips.columns["a"], flips.columns["b"]
    np.testing.assert_allclose(a, 3.0 * (1.0 - b) ** 2 / 4.0, atol=1e-9)
    [point] = [point for point in flips.points if point.type == "R2"]
    assert (point.values["a"], point.values["b"]) == pytest.approx((3.0, -1.0), abs=1e-7)


@pytest.mark.long
def test_a_cusp_of_orbits_has_its_coefficient_with_its_error():
    """x -> m + a x - x^3: the folds 27 m^2 = 4 (a - 1)^3 meet at (0, 1), where P'''/6 = -1."""
    model = Model(
        "cusp", states={"s": 0.0, "x": 0.8}, parameters={"m": 0.05, "a": 1.2}, equations={"s": "1", "x": "0"},
        events=[{"when": "s - 1", "direction": "up", "set": {"s": 0, "x": "m + a*x - x^3"}}],
    )  # fmt: skip
    line = contin.continuation(contin.periodic_orbit(model), "m", (-0.1, 0.1))
    curve = contin.continuation(line["LPC1"].locus(), ("m", "a"), {"m": (-0.1, 0.2), "a": (0.8, 1.8)})
    np.testing.assert_allclose(27.0 * curve.columns["m"] ** 2, 4.0 * (curve.columns["a"] - 1.0) ** 3, atol=1e-9)
    [point] = curve.points
    assert point.label == "CPC1"
    assert (point.values["m"], point.values["a"]) == pytest.approx((0.0, 1.0), abs=1e-7)
    c, error = point.normal_form["c_map"], point.normal_form["errors"]["c_map"]
    assert abs(abs(c) - 1.0) <= error < 1e-3


@pytest.mark.long
def test_tori_of_a_delayed_logistic_map_of_jumps():
    """x -> a x (1 - y) + c x, y -> x: the determinant a x is 1 on the curve."""
    model = Model(
        "delayed", states={"s": 0.0, "x": 0.4, "y": 0.4}, parameters={"a": 1.95, "c": 0.0},
        equations={"s": "1", "x": "0", "y": "0"},
        events=[{"when": "s - 1", "direction": "up", "set": {"s": 0, "x": "a*x*(1 - y) + c*x", "y": "x"}}],
    )  # fmt: skip
    line = contin.continuation(contin.periodic_orbit(model), "a", (1.9, 2.1))
    curve = contin.continuation(line["NS1"].locus(), ("a", "c"), {"a": (1.9, 2.1), "c": (-0.5, 0.5)})
    np.testing.assert_allclose(curve.columns["a"] * curve.columns["x.max"], 1.0, rtol=1e-8)  # det = a x
    np.testing.assert_allclose(curve.columns["cos.theta"], 0.5, atol=1e-8)  # trace = a (1 - x) + c = 1
    assert curve.locus == "NS"


@pytest.mark.seldom
def test_a_curve_ends_where_its_orbit_grazes_another_surface():
    """Doublings at x = (1 + a)/(2 a); the orbit touches x sin(pi s) = h at x = h: a = 1/(2 h - 1)."""
    start = contin.periodic_orbit(HOOP, {"x": 0.6}, {"a": 2.9})
    line = contin.continuation(start, "a", (2.88, 3.05), settings={"stop_at": ("PD",), **LONG})
    curve = contin.continuation(line["PD1"].locus(), ("a", "b"), {"a": (2.45, 3.02), "b": (-1.0, 1.0)}, settings=LONG)
    [end] = [end for end in curve.ends if end.reason == "grazing"]
    assert "event 2" in end.text
    assert end.data["at"] == pytest.approx({"a": 2.5, "b": 0.175}, abs=1e-6)
    assert np.all(curve.columns["x.max"] < 0.7 + 1e-9)


@pytest.mark.long
def test_a_curve_from_a_file_is_that_of_the_session(henon, tmp_path):
    save_branches([henon], tmp_path / "h.contin")
    point = contin.read(tmp_path / "h.contin")["branch"]["PD1"]
    curve = contin.continuation(point.locus(), ("a", "b"), {"a": (0.0, 4.0), "b": (-0.91, -0.89)})
    same = contin.continuation(henon["PD1"].locus(), ("a", "b"), {"a": (0.0, 4.0), "b": (-0.91, -0.89)})
    np.testing.assert_array_equal(curve.columns["a"], same.columns["a"])
