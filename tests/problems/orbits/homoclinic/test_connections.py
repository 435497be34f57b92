"""Curves of homoclinic orbits: a closed form."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.problems.loci.planes import BOGDANOV_TAKENS, curves_through


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
