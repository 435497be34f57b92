"""Coefficients of points of codimension two of cycles by shooting: return maps that are flows of known equations.

The field of the circle may jump in length where a surface is crossed, which changes times and no return map.
"""

from __future__ import annotations

import re
from math import asin, pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import SQUARE, orbit_on_circle, twisted
from tests.loci.orbits.test_coefficients import CUBIC, PAIR, assert_within, point, resonant
from tests.loci.orbits.test_interacting_coefficients import fold_form

T = 2 * pi
SHOT = {"method": "shooting"}
LEAST = 1e-4  # of a coefficient: errors of differences
ABOVE = pi - 2 * asin(0.1)  # of a turn, where b > 0.1
JUMPING = {"factor": "(2 if b > 0.1 else 1)", "period": T - ABOVE / 2}
ALSO_JUMPING = pytest.param(JUMPING, id="jumping", marks=pytest.mark.long)


@pytest.mark.parametrize("change", [pytest.param({}, id="smooth"), ALSO_JUMPING])
@pytest.mark.seldom
def test_flip_torus(change):
    r = "(e^2 + f^2)"
    x, y = amplitude("e", "f", f"p + 0.5*{SQUARE} - 0.7*{r}", "0.15")
    equations = {**twisted(f"p/2 + q + 0.3*{SQUARE} - 0.2*{r}", "-1"), "e": x, "f": y}
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    form = point(equations, "NS", "PDNS", box, **SHOT, **change).normal_form
    if not change:
        for key, value in {"p11": 0.3, "p12": -0.4, "p21": 0.5, "p22": -1.4}.items():
            assert_within(form, key, T * value, LEAST)
    assert_within(form, "theta", 0.4 / 1.4, LEAST)
    assert_within(form, "delta", 0.5 / 0.3, LEAST)
    assert form["case"] == "difficult case III"


@pytest.mark.seldom
def test_two_tori():
    one, two = "(c^2 + d^2)", "(e^2 + f^2)"
    v = amplitude("c", "d", f"p - 0.3*{one} - 0.2*{two}", "0.3")
    w = amplitude("e", "f", f"p/2 + q - 0.5*{one} - 0.7*{two}", "0.22")
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    form = point(dict(zip("cdef", (*v, *w), strict=True)), "NS", "NSNS", box, **SHOT).normal_form
    for key, value in {"p11": -0.3, "p12": -0.2, "p21": -0.5, "p22": -0.7}.items():
        assert_within(form, key, 2 * T * value, LEAST)
    assert form["case"] == "simple case II"


@pytest.mark.parametrize(
    "factor",
    [pytest.param("1", id="plain", marks=pytest.mark.long), pytest.param("(1 + a/2 + 0.3*x)", id="period")],
)
@pytest.mark.seldom
def test_fold_torus(factor):
    x, y = amplitude("c", "d", "q + 0.2*x + 0.4*x^2 - (c^2 + d^2)", "0.3")
    form = fold_form({"x": "p - x^2 - 0.8*(c^2 + d^2)", "c": x, "d": y}, "LPNS", factor, **SHOT)
    assert_within(form, "theta", -0.2, LEAST)
    assert_within(form, "E", (0.4 + 1.2 / 0.8) / T, LEAST)
    assert_within(form, "c", 1.0, LEAST)
    assert form["case"] == "s = 1, theta < 0, torus unstable"


@pytest.mark.seldom
def test_fold_flip():
    flips = twisted(f"q - 0.25*x + 0.4*x^2 - 0.7*{SQUARE}", "-1")
    form = fold_form({"x": f"p - x^2 + 0.8*{SQUARE}", **flips}, "LPPD", **SHOT)
    assert_within(form, "a", -4.0, LEAST)
    assert_within(form, "b", 0.2 * T * T, LEAST)
    assert_within(form, "c", 16.0, LEAST)
    assert form["case"].startswith("a < 0, b > 0, invariant curve of the doubled orbit ")


@pytest.mark.parametrize("change", [pytest.param({}, id="smooth"), ALSO_JUMPING])
@pytest.mark.seldom
def test_strong_resonances_of_pairs(change):
    """As those by collocation: a = Re C / (6 pi B^2) of R3, A0 = C / |D| of R4."""
    form = point(resonant(0.5, 2), "NS", "R3", {**PAIR, "q": (0.3, 0.36)}, **SHOT, **change).normal_form
    assert_within(form, "a", -CUBIC[0] / (6 * pi * 0.25), LEAST)
    assert form["case"] == "invariant circle stable"
    form = point(resonant(0.6, 3), "NS", "R4", {**PAIR, "q": (0.22, 0.28)}, **SHOT, **change).normal_form
    assert_within(form, "A0", [-CUBIC[0] / 0.6, -CUBIC[1] / 0.6], LEAST)
    assert form["case"] == "|A0| < 1"


@pytest.mark.seldom
def test_one_to_two_resonance():
    box = {"p": (-0.15, 0.15), "q": (-0.15, 0.12)}
    equations = twisted("0", f"q - 0.8*{SQUARE}", along_by_z="1", across_by_s=f"p - 0.5*{SQUARE}")
    form = point(equations, "PD", "R2", box, **SHOT).normal_form
    assert_within(form, "C1", -0.5 * (4 * pi) ** 2, LEAST)
    assert_within(form, "D1", -0.8 * 4 * pi, LEAST)
    assert form["case"] == "C1 < 0, D1 < 0"


@pytest.mark.seldom
def test_one_to_one_resonance():
    form = fold_form({"x": "y", "y": "p - x^2 + q*y + x*y"}, "R1", **SHOT)
    assert_within(form, "a", -(T**2), LEAST)
    assert_within(form, "b", T - 2 * T**2, LEAST)
    assert form["s"] == -1


def test_cusp():
    """x' = p + q x - 0.3 x^3 over 2 pi: x -> x - 0.3 T x^3."""
    orbit = orbit_on_circle({"x": "p + q*x - 0.3*x^3"}, {"p": 0.6, "q": 0.8}, 1.887, "shooting")
    box = {"p": (-1.5, 1), "q": (-0.5, 1.5)}
    family = contin.continuation(orbit, "p", box["p"], settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": ("CPC",)})
    assert_within(folds["CPC1"].normal_form, "c", -0.3, LEAST)


@pytest.mark.seldom
def test_degenerate_period_doubling():
    """s' = p s + q s^3 - 0.7 s^5 in the turning plane: derivatives of fifth order."""
    box = {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}
    form = point(twisted(f"p + q*{SQUARE} - 0.7*({SQUARE})^2", "-1"), "PD", "GPD", box, **SHOT).normal_form
    assert_within(form, "e", -0.7, 1e-3)
    assert "case" not in form


@pytest.mark.parametrize(
    "change", [pytest.param({}, id="smooth", marks=pytest.mark.long), pytest.param(JUMPING, id="jumping")]
)
@pytest.mark.seldom
def test_degenerate_torus(change):
    """v' = (p + q R - 0.7 R^2 + i (0.3 + R/10)) v with R = |v|^2 = 2 |xi|^2, over 2 pi, as a rate."""
    x, y = amplitude("c", "d", "p + q*(c^2 + d^2) - 0.7*(c^2 + d^2)^2", "(0.3 + 0.1*(c^2 + d^2))")
    box = {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}
    form = point({"c": x, "d": y}, "NS", "CH", box, **SHOT, **change).normal_form
    assert_within(form, "l2", -2.8 * T / change.get("period", T), 1e-3)
    assert "case" not in form


@pytest.mark.parametrize("method", ["shooting", "collocation"])
def test_forced_cycles(method):
    """x' = p - x^2 + 0.8 s^2 and s' = (q - 0.25 x - 0.7 s^2) s, where s turns half round in a forcing period.

    At the point all states rest at 0 but for rounding, and have the sizes of the model's starts.
    """
    turning = {"a": "cos(t)", "b": "sin(t)"}
    plane = {"x": f"p - x^2 + 0.8*{SQUARE}", **twisted(f"q - 0.25*x - 0.7*{SQUARE}", "-1")}
    equations = {n: re.sub(r"\b[ab]\b", lambda m: turning[m.group()], text) for n, text in plane.items()}
    model = Model("forced", states={"x": 0.5, "c": 0.0, "d": 0.0}, parameters={"p": 0.25, "q": -0.3},
                  equations=equations, forcing={"period": "2*pi"})  # fmt: skip
    start = np.tile([0.5, 0.0, 0.0], (101, 1))
    orbit = contin.periodic_orbit(model, start, period=T, method=method)
    box = {"p": (-0.5, 0.5), "q": (-0.3, 0.4)}
    family = contin.continuation(orbit, "p", box["p"], direction="down", settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": ("LPPD",)})
    form = next(p for p in folds.points if p.type == "LPPD").normal_form
    assert_within(form, "a", -4.0, LEAST)
    assert_within(form, "b", 0.2 * T * T, LEAST)
