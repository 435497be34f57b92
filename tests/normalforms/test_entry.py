"""Jets of compiled systems; the entry by type code; words."""

import numpy as np
import pytest

from contin.normalforms.hopf import hopf
from contin.normalforms.jet import DerivativeJet
from contin.normalforms.point import normal_form
from contin.normalforms.sources import compiled_jet
from contin.normalforms.words import describe
from contin.special.table import table

from .formulas import taylor_jet
from .polynomials import hide, rotation_field


class Cubic:
    """A stand-in for a compiled system: u' = polynomial, two parameters, exact derivatives by sympy at any point."""

    formulas = ("m*x - w*y - (x**2 + y**2)*x + x*y", "w*x + m*y - (x**2 + y**2)*y - x**2")

    def _jet(self, u, p):
        at = {"x": u[0], "y": u[1], "m": p[0], "w": p[1]}
        return taylor_jet(["x", "y"], ["m", "w"], self.formulas, at)

    def jacobian(self, u, p):
        jet = self._jet(u, p)
        return np.zeros(2), np.array([jet.form(e) for e in np.eye(4)]).T

    def derivative(self, u, p, *directions):
        assert all(len(d) == 4 for d in directions)
        return self._jet(u, p).form(*directions)

    def derivatives(self, u, p, *directions):
        return np.array([self.derivative(*place) for place in zip(u, p, *directions, strict=True)])


def test_compiled_jet_places_the_active_parameters():
    u, p = np.zeros(2), np.array([0.0, 1.3])
    jet = compiled_jet(Cubic(), u, p, active=(1,))
    exact = taylor_jet(["x", "y"], ["w"], [f.replace("m", "0") for f in Cubic.formulas], {"x": 0, "y": 0, "w": 1.3})
    rng = np.random.default_rng(0)
    d = rng.normal(size=(3, 3)) + 1j * rng.normal(size=(3, 3))
    for k in (1, 2, 3):
        np.testing.assert_allclose(jet.form(*d[:k]), exact.form(*d[:k]), atol=1e-13)
    assert (jet.n, jet.parameters) == (2, 1)
    assert hopf(jet).coefficients["c1"] == pytest.approx(hopf(exact).coefficients["c1"])


def test_conjugate_and_repeated_directions_share_their_evaluations():
    calls = []

    def derivative(directions):
        calls.append(directions)
        return np.array([np.prod([d.sum() for d in directions])])

    jet = DerivativeJet(np.zeros((1, 1)), derivative)
    q = np.array([0.3 + 0.4j])
    value = jet.form(q, q, q, q.conj(), q.conj())
    assert value[0] == pytest.approx(q[0] ** 3 * np.conj(q[0]) ** 2)
    assert len(calls) <= 6


def test_every_type_with_a_normal_form_has_words_and_an_unknown_type_is_named():
    assert all(row.order > 0 for row in table().values() if row.normal_form)
    jet, _ = hide([{(1, 0): 0.0, (1, 1): 1.0, (3, 0): -1.0}], [-1.0], np.random.default_rng(0), 3, parameters=1)
    form = normal_form("BP", jet)
    assert describe("BP", form.coefficients) == "supercritical pitchfork"
    assert describe("LP", {"kind": "nonsmooth"}) == "nonsmooth fold"
    assert describe("BP", {"kernel": 2, "kind": "multiple"}) == "branch point with a 2-dimensional kernel"
    assert describe("HOM", {"kind": "heteroclinic"}) == "heteroclinic orbit"
    assert describe("XY") == "XY"
    with pytest.raises(ValueError, match="no normal form for type 'UZ' here; known: BP, HB, LP"):
        normal_form("UZ", jet)


def test_coefficients_are_plain_data():
    import json

    jet, _ = hide(rotation_field(1.7j, {1: -0.5 + 0.3j}), [-0.8], np.random.default_rng(1), 3)
    text = json.dumps(normal_form("HB", jet).coefficients)
    assert json.loads(text)["criticality"] == "supercritical"
    jet, _ = hide([{(1, 0): 0.0, (1, 1): 1.0, (3, 0): -1.0}], [-1.0], np.random.default_rng(0), 3, parameters=1)
    assert json.loads(json.dumps(normal_form("BP", jet).coefficients))["kind"] == "pitchfork"
