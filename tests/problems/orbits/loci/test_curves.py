"""Curves of LPC, PD and NS of periodic orbits in two parameters: closed forms and independently computed points."""

from __future__ import annotations

from math import cos, pi

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model
from tests.problems.loci.planes import amplitude
from tests.problems.orbits.test_families import cycles, labels


def curve(point, names, box, **options):
    return contin.continuation(point.locus(names), names, box, **options)


@pytest.fixture(scope="module")
def bautin():
    """w' = (p + q s - s^2 + i) w, s = |w|^2: orbits s = q/2 +- sqrt(q^2/4 + p) fold where p = -q^2/4."""
    growth = "p + q*(x^2 + y^2) - (x^2 + y^2)^2"
    x, y = amplitude("x", "y", growth, "1")
    return Model("bautin", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 1}, equations={"x": x, "y": y})


def test_folds_of_the_bautin_normal_form_lie_on_the_parabola(bautin):
    family = cycles(bautin, "p", (-0.5, 0.5))
    folds = curve(family["LPC1"], ("p", "q"), {"p": (-2, 0.5), "q": (0.2, 2)})
    p, q = folds.columns["p"], folds.columns["q"]
    np.testing.assert_allclose(p, -(q**2) / 4, atol=1e-9)
    np.testing.assert_allclose(folds.columns["x.max"] ** 2, q / 2, atol=1e-7)
    np.testing.assert_allclose(folds.columns["period"], 2 * pi, rtol=1e-9)
    assert [end.reason for end in folds.ends] == ["bound", "bound"]
    assert labels(folds, "CPC") == []


def two_oscillators(turn: str = "0.4"):
    """Orbits |w|^2 = p of period 2 pi; a second, damped oscillator v' = (q - |w|^2 + i turn) v, weakly nonlinear.

    Multipliers exp(2 pi (q - p + i turn)): tori are born where p = q.
    """
    first = amplitude("a", "b", "p - a^2 - b^2", "1")
    second = amplitude("c", "d", "q - a^2 - b^2 - (c^2 + d^2)", turn)
    equations = dict(zip("abcd", (*first, *second), strict=True))
    return Model("two", states=dict.fromkeys("abcd", 0), parameters={"p": -0.5, "q": 0.4}, equations=equations)


def test_tori_of_two_oscillators_are_born_on_the_diagonal_with_the_angle_of_the_second():
    family = cycles(two_oscillators(), "p", (-0.5, 1.0), label="HB1")
    point = next(p for p in family.points if p.type == "NS")
    tori = curve(point, ("p", "q"), {"p": (0.2, 1.0), "q": (0.2, 1.0)})
    np.testing.assert_allclose(tori.columns["p"], tori.columns["q"], atol=1e-9)
    np.testing.assert_allclose(np.cos(angle(tori)), cos(2 * pi * 0.4), atol=1e-8)
    assert [end.reason for end in tori.ends] == ["bound", "bound"]
    assert labels(tori, "R1 R2 R3 R4 NSNS") == []


def angle(branch):
    return np.arccos(branch.columns["cos.theta"])


def test_a_user_of_a_point_without_a_curve_is_told_which_points_have_one(bautin):
    family = cycles(bautin, "p", (-0.5, 0.5), values={"p": [0.25]})
    with pytest.raises(InputError, match="LPC, PD, NS"):
        family["UZ1"].locus(("p", "q"))


def test_period_doublings_of_the_roessler_system_pass_through_published_points():
    """x' = -y - z, y' = x + a y, z' = b + z (x - c) with b = 2; points of AUTO-07p (NTST 50, EPSL 1e-10)."""
    model = Model(
        "roessler", states={"x": 0, "y": 0, "z": 0}, parameters={"a": 0.2, "b": 2, "c": 5},
        equations={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    )  # fmt: skip
    rest = contin.equilibrium(model, {"x": 0.4, "y": -2, "z": 2}, {"a": 0.1})
    line = contin.continuation(rest, "a", (0.05, 0.5))
    family = contin.continuation(line["HB1"].switch(), "a", (0.05, 0.5))
    doublings = curve(
        family["PD1"], ("c", "a"), {"c": (4.9, 7.1), "a": (0.05, 0.5)}, values={"c": [5, 6, 7]},
    )  # fmt: skip
    found = {round(p.values["c"]): p.values["a"] for p in labels(doublings, "UZ")}
    assert found == pytest.approx({5: 0.2634689961, 6: 0.2202132777, 7: 0.1903102199}, abs=2e-10)
