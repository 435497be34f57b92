"""Curves of homoclinic orbits: a closed form."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import BOGDANOV_TAKENS, curves_through


@pytest.fixture(scope="module")
def leaf():
    """x^2 (1 - x) = y^2 is a homoclinic orbit of the origin at m = 0 for every a; eigenvalues a +- b there.

    Sandstede, J. Dynam. Differential Equations 9 (1997) 269, without the third equation.
    """
    return Model(
        "leaf", states={"x": 0.6, "y": 0}, parameters={"m": 0.4, "a": -0.25, "b": 1},
        equations={"x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y"},
    )  # fmt: skip


@pytest.fixture(scope="module")
def loops(leaf):
    line = contin.continuation(contin.equilibrium(leaf), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1))
    assert family["HOM1"].normal_form["at"]["m"] == pytest.approx(0, abs=1e-7)
    box = {"m": (-0.5, 0.5), "a": (-0.35, 0.15)}
    return contin.continuation(family["HOM1"].locus(("m", "a")), ("m", "a"), box)


@pytest.mark.seldom
def test_homoclinic_orbits_of_the_cubic_leaf_have_m_zero_and_its_extent(loops):
    assert loops.locus == "HOM"
    assert [end.reason for end in loops.ends] == ["bound", "bound"]
    np.testing.assert_allclose(loops.columns["m"], 0, atol=1e-7)
    np.testing.assert_allclose(loops.columns["x.max"], 1, atol=1e-6)
    np.testing.assert_allclose(loops.columns["y.max"], 2 / np.sqrt(27), atol=1e-6)
    np.testing.assert_allclose(loops.columns["x.saddle"], 0, atol=1e-12)


def test_their_only_special_point_is_the_resonance_where_the_trace_vanishes(loops):
    assert [point.type for point in loops.points] == ["NSS"]
    assert loops["NSS1"].values["a"] == pytest.approx(0, abs=1e-8)


def test_homoclinic_orbits_leave_a_bogdanov_takens_point_as_the_normal_form_says():
    """x' = y, y' = p + q x + x^2 - x y: p = -(6/25) q^2 + O(q^3), q < 0 (Kuznetsov, Elements, 3rd ed., sec. 8.4)."""
    folds = BOGDANOV_TAKENS.curve("LP1")
    (loops,) = curves_through(folds["BT1"], orbits=True, settings={"steps": 12})
    p, q = loops.columns["p"], loops.columns["q"]
    assert loops.locus == "HOM"
    assert loops.ends[0].reason == "start"
    assert np.all(np.diff(q) < 0)
    assert np.all(q < 0)
    slope, at_point = np.polyfit(q, p / q**2, 1)
    assert at_point == pytest.approx(-6 / 25, abs=2e-4)
    assert abs(slope) < 0.1


@pytest.mark.parametrize(("sign", "label"), [pytest.param(1, "OFS", marks=pytest.mark.long), (-1, "OFU")])
@pytest.mark.seldom
def test_orbits_flip_where_the_leading_direction_is_not_excited(sign, label):
    """The leaf drives z' = c z + k x, c = -0.5 the slowest stable rate: m = 0 for all k, and the orbit returns along z,
    its part there being k times the integral of exp(0.5 s) x(s) > 0. In reversed time it leaves that way."""
    leaf = {"x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y"}
    equations = {name: f"{sign}*({f})" for name, f in {**leaf, "z": "-0.5*z + k*x"}.items()}
    model = Model(
        "driven-leaf", states={"x": 0.6, "y": 0, "z": -0.3}, parameters={"m": 0.4, "k": -0.3, "a": -0.25, "b": 1},
        equations=equations,
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1))
    loops = contin.continuation(family["HOM1"].locus(("m", "k")), ("m", "k"), {"m": (-0.5, 0.5), "k": (-0.4, 0.5)})
    np.testing.assert_allclose(loops.columns["m"], 0, atol=1e-7)
    assert [point.type for point in loops.points] == [label]
    assert loops.points[0].values["k"] == pytest.approx(0, abs=1e-6)


@pytest.fixture(scope="module")
def nagumo():
    """u'' + c u' + u (1 - u) (u - a) = 0."""
    return Model(
        "nagumo", states={"u": 0, "v": 0}, parameters={"a": 0.25, "c": 0.35},
        equations={"u": "v", "v": "-c*v - u*(1 - u)*(u - a)"},
    )  # fmt: skip


def test_fronts_of_the_nagumo_equation_have_the_speed_of_huxley(nagumo):
    """From u = 1 to u = 0: u = 1/(1 + exp(s/sqrt(2))), v = -u (1 - u)/sqrt(2), c = (1 - 2 a)/sqrt(2)."""
    box = {"c": (-1, 1), "a": (0.02, 0.48)}
    fronts = contin.continuation(contin.connecting_orbit(nagumo, {"u": 1}, {"u": 0}), ("c", "a"), box)
    assert [end.reason for end in fronts.ends] == ["bound", "bound"]
    a, c = fronts.columns["a"], fronts.columns["c"]
    np.testing.assert_allclose(c, (1 - 2 * a) / np.sqrt(2), atol=1e-7)
    np.testing.assert_allclose(fronts.columns["v.min"], -1 / np.sqrt(32), atol=1e-6)
    np.testing.assert_allclose(fronts.columns["u.saddle"], 1, atol=1e-10)
    np.testing.assert_allclose(fronts.columns["u.saddle2"], 0, atol=1e-10)


def test_a_loop_of_the_nagumo_equation_is_conservative(nagumo):
    """A homoclinic orbit of u = 0 for c = 0, a < 1/2: v^2 = a u^2 - 2 (1 + a) u^3/3 + u^4/2, energy being conserved."""
    start = contin.connecting_orbit(nagumo, {"u": 0}, parameters={"c": 0.001})
    loops = contin.continuation(start, ("c", "a"), {"c": (-1, 1), "a": (0.1, 0.4)})
    a = loops.columns["a"]
    turning = (2 * (1 + a) - np.sqrt(4 * (1 + a) ** 2 - 18 * a)) / 3
    np.testing.assert_allclose(loops.columns["c"], 0, atol=1e-8)
    np.testing.assert_allclose(loops.columns["u.max"], turning, atol=1e-6)


def test_pushed_fronts_end_where_the_strong_direction_is_none_any_more(nagumo):
    """Into u = 0 with a < 0, a node seen from the front: u = 1/(1 + exp(s/sqrt(2))) lies on its strong manifold, rates
    1/sqrt(2) and -a sqrt(2), up to a = -1/2, where both are one."""
    start = contin.connecting_orbit(nagumo, {"u": 0}, {"u": 1}, parameters={"a": 0.3, "c": -0.25})
    fronts = contin.continuation(start, ("a", "c"), {"a": (-0.9, 0.4), "c": (-2, 2)}, direction="down")
    a = fronts.columns["a"]
    assert fronts.ends[0].reason == "bound"
    assert "rates" in fronts.ends[0].text
    assert -0.5 < a[0] < -0.4
    np.testing.assert_allclose(fronts.columns["c"], -(1 - 2 * a) / np.sqrt(2), atol=1e-6)
    assert fronts.points == ()
