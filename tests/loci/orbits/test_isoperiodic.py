"""Orbits of one period in two parameters."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_orbits_with_a_period_that_depends_on_their_size_lie_on_a_line(method):
    """w' = (p - s + i (1 + q + s)) w, s = |w|^2 = p: the period 2 pi/(1 + q + p) is constant along q = c - p."""
    x, y = amplitude("x", "y", "p - x^2 - y^2", "(1 + q + x^2 + y^2)")
    model = Model("sheared", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 0.0}, equations={"x": x, "y": y})
    line = contin.continuation(contin.equilibrium(model), "p", (-0.5, 1))
    options = {"values": {"p": [0.5]}, "settings": {"method": method}}
    family = contin.continuation(line["HB1"].switch(), "p", (-0.5, 1), **options)
    box = {"p": (0.2, 1), "q": (-0.4, 0.4)}
    curve = contin.continuation(family["UZ1"].locus(("p", "q")), ("p", "q"), box)
    np.testing.assert_allclose(curve.columns["p"] + curve.columns["q"], 0.5, atol=1e-9)
    np.testing.assert_allclose(curve.columns["x.max"] ** 2, curve.columns["p"], atol=1e-7)
    np.testing.assert_allclose(curve.columns["period"], 2 * np.pi / 1.5, rtol=1e-9)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_orbits_of_one_period_end_where_they_are_born(method):
    """As above: the line comes to the Hopf curve p = 0 at q = 1/2, beyond which the same orbits would follow again."""
    x, y = amplitude("x", "y", "p - x^2 - y^2", "(1 + q + x^2 + y^2)")
    model = Model("sheared", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 0.0}, equations={"x": x, "y": y})
    line = contin.continuation(contin.equilibrium(model), "p", (-0.5, 1))
    options = {"values": {"p": [0.5]}, "settings": {"method": method}}
    family = contin.continuation(line["HB1"].switch(), "p", (-0.5, 1), **options)
    box = {"p": (-0.5, 1), "q": (-0.4, 0.8)}
    curve = contin.continuation(family["UZ1"].locus(("p", "q")), ("p", "q"), box)
    p = curve.columns["p"]
    assert np.all(np.diff(p) > 0.0) or np.all(np.diff(p) < 0.0)
    assert sorted(end.reason for end in curve.ends) == ["bound", "hopf"]
    assert p.min() == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(p + curve.columns["q"], 0.5, atol=1e-9)


def test_relay_oscillations_of_one_period_lie_where_their_half_turn_says():
    """x'' + 2 d x' + w2 x = k sign(x'): half a turn of the damped oscillator takes pi/sqrt(w2 - d^2)."""
    model = Model(
        "relay", states={"x": 1.0, "y": 0.1}, parameters={"d": 0.2, "w2": 1.0, "k": 0.5},
        equations={"x": "y", "y": "-2*d*y - w2*x + k*sign(y)"},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(model), "d", (0.1, 0.3), values={"d": [0.25]})
    box = {"d": (0.1, 0.5), "w2": (0.5, 1.5)}
    curve = contin.continuation(family["UZ1"].locus(("d", "w2")), ("d", "w2"), box)
    assert curve.locus == "UZ"
    np.testing.assert_allclose(curve.columns["w2"] - curve.columns["d"] ** 2, 1 - 0.25**2, atol=1e-9)
    np.testing.assert_allclose(curve.columns["period"], 2 * np.pi / np.sqrt(1 - 0.25**2), rtol=1e-10)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert np.all(curve.columns["stable"])


def test_long_orbits_lie_beside_the_homoclinic_ones():
    """The leaf x^2 (1 - x) = y^2 at m = 0 (Sandstede 1997): eigenvalues a +- 1, m = O(exp(-(1 + a) T))."""
    leaf = {"x": "a*x + y - a*x^2 + m*x*(2 - 3*x)", "y": "x + a*y - 1.5*x^2 - 1.5*a*x*y - 2*m*y"}
    model = Model("leaf", states={"x": 0.6, "y": 0}, parameters={"m": 0.4, "a": -0.25}, equations=leaf)
    line = contin.continuation(contin.equilibrium(model), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1), values={"period": [18]})
    box = {"m": (-0.5, 0.5), "a": (-0.3, -0.15)}
    curve = contin.continuation(family["UZ1"].locus(("m", "a")), ("m", "a"), box)
    a, m = curve.columns["a"], curve.columns["m"]
    assert (a.min(), a.max()) == pytest.approx((-0.3, -0.15))
    assert np.all(np.abs(m) < 10 * np.exp(-18 * (1 + a)))
    assert np.all(m != 0.0)


def test_a_parameter_that_the_model_does_not_have_is_named():
    x, y = amplitude("x", "y", "p - x^2 - y^2", "1")
    model = Model("plain", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 0.0}, equations={"x": x, "y": y})
    line = contin.continuation(contin.equilibrium(model), "p", (-0.5, 1))
    family = contin.continuation(line["HB1"].switch(), "p", (-0.5, 1), values={"p": [0.5]})
    with pytest.raises(InputError, match="no parameter 'r'"):
        family["UZ1"].locus(("p", "r"))
