"""LPPD, LPNS, PDNS and NSNS of cycles whose return map is the flow of known amplitude equations over 2 pi.

The circle (a, b) = e(phi) of `test_codim_two` carries further states; `test_coefficients` says what a factor of the
field and a linear change of the states do to the map: nothing.
"""

from __future__ import annotations

import re
from math import pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted
from tests.loci.orbits.test_coefficients import assert_within, changed, leaning, point

T = 2 * pi
PLACES = [{}, {"factor": "(1 + a/2 + 0.3*x)"}, {"leans": True}]
NAMES = ["plain", "period", "leaning"]


def fold_form(
    equations: dict[str, str], type_: str, factor: str = "1", leans: bool = False, method: str = "collocation"
):
    """The form at the first point of a type on the curve of folds from the cycle with x = 0.5, p = 0.25, q = -0.3."""
    whole = {**CIRCLE, **equations}
    matrix = leaning(len(whole)) if leans else np.eye(len(whole))
    angle = np.linspace(0, T, 401)
    u = np.zeros((len(angle), len(whole)))
    u[:, 0], u[:, 1], u[:, 2] = np.cos(angle), np.sin(angle), 0.5
    speed = np.ones(len(angle)) if factor == "1" else 1 + np.cos(angle) / 2 + 0.3 * 0.5
    time = np.concatenate([[0.0], np.cumsum(np.diff(angle) * (1 / speed[1:] + 1 / speed[:-1]) / 2)])
    at = np.linspace(0, time[-1], 201)
    u = np.column_stack([np.interp(at, time, column) for column in u.T]) @ matrix.T
    model = Model(
        "circle", states=dict(zip(whole, u[0].tolist(), strict=True)), parameters={"p": 0.25, "q": -0.3},
        equations=changed(whole, factor, matrix),
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, u, period=float(time[-1]), method=method)
    family = contin.continuation(orbit, "p", (-0.5, 0.5), direction="down", settings={"stop_at": ("LPC",)})
    box = {"p": (-0.5, 0.5), "q": (-0.3, 0.4)}
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": (type_,)})
    return next(p for p in folds.points if p.type == type_).normal_form


def signs(size):
    """The first sign in every place; the other where nothing is changed, and everywhere in the long run."""
    return [
        pytest.param(value, change, id=f"{value}-{name}", marks=pytest.mark.long if value < 0 and change else ())
        for value in (size, -size)
        for name, change in zip(NAMES, PLACES, strict=True)
    ]


@pytest.mark.parametrize(("s", "change"), signs(0.8))
def test_fold_torus(change, s):
    """x' = p - x^2 + s R, v' = (q + 0.2 x + 0.4 x^2 - R + 0.3 i) v with R = |v|^2: the field of a zero-Hopf point.

    In units of x in which x' = x^2 over one turn: theta = -0.2, E = (0.4 - 0.2/s - 1/s) / T.
    """
    x, y = amplitude("c", "d", "q + 0.2*x + 0.4*x^2 - (c^2 + d^2)", "0.3")
    form = fold_form({"x": f"p - x^2 + {s}*(c^2 + d^2)", "c": x, "d": y}, "LPNS", **change)
    E = (0.4 - 1.2 / s) / T
    assert_within(form, "theta", -0.2)
    assert_within(form, "E", E)
    assert_within(form, "c", 1.0)
    assert_within(form, "a", [-0.2 * np.cos(0.6 * pi), -0.2 * np.sin(0.6 * pi)])
    assert form["angle"] == pytest.approx(0.6 * pi, abs=1e-8)
    assert form["s"] == -np.sign(s)
    torus = f"torus {'stable' if E < 0 else 'unstable'}" if form["s"] > 0 else "no torus"
    assert form["case"] == f"s = {form['s']}, theta < 0, {torus}"
    if not change:  # x and sqrt(2) |xi| in place of w0 and |w1|
        assert abs(form["f200"]) == pytest.approx(T, rel=1e-8)
        assert abs(form["f011"]) == pytest.approx(2 * abs(s) * T, rel=1e-8)


@pytest.mark.parametrize(("k", "change"), signs(0.25))
def test_fold_flip(change, k):
    """x' = p - x^2 + 0.8 s^2, s' = (q + k x + 0.4 x^2 - 0.7 s^2) s in the turning plane."""
    flips = twisted(f"q + {k}*x + 0.4*x^2 - 0.7*{SQUARE}", "-1")
    form = fold_form({"x": f"p - x^2 + 0.8*{SQUARE}", **flips}, "LPPD", **change)
    b, d = -0.8 * k * T * T, amplitude_d(-T, 0.8 * T, k * T, 0.4 * T, -0.7 * T)
    assert_within(form, "a", 1 / k)
    assert_within(form, "c", 1 / k**2)
    if not change.get("leans"):  # which changes the length of the doubling eigenfunction
        assert_within(form, "b", b)
        assert_within(form, "d", d)
    curve = 3 * b / k**2 - (2 * b / k + 3 * b + d) / k
    stable = f", invariant curve of the doubled orbit {'stable' if curve < 0 else 'unstable'}" if b > 0 else ""
    assert form["case"] == f"a {'<>'[k > 0]} 0, b {'<>'[b > 0]} 0{stable}"


def amplitude_d(f20: float, f02: float, g11: float, g21: float, g03: float) -> float:
    """d of (x, -s) after the flow of x' = f20 x^2 + f02 s^2, s' = (g11 x + g21 x^2 + g03 s^2) s over the time 1."""
    map12, map11 = f20 * f02 + f02 * g11, -g11
    map21, map03 = -(g21 + g11 * (f20 + g11) / 2), -(g03 + g11 * f02 / 2)
    return map12 + 2 * (f02 * map21 - map03 * (f20 + map11)) / map11


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_flip_torus(turn):
    """s' = (q + p/2 + 0.3 s^2 - 0.2 R) s in the turning plane, v' = (p + 0.5 s^2 - 0.7 R + 0.15 i) v."""
    r = "(e^2 + f^2)"
    x, y = amplitude("e", "f", f"p + 0.5*{SQUARE} - 0.7*{r}", "0.15")
    equations = {**twisted(f"p/2 + q + 0.3*{SQUARE} - 0.2*{r}", "-1"), "e": x, "f": y}
    form = point(equations, "NS", "PDNS", {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}, turn=turn).normal_form
    for key, value in {"p11": 0.3, "p12": -0.4, "p21": 0.5, "p22": -1.4}.items():  # R = 2 |xi|^2
        assert_within(form, key, T * value)
    assert_within(form, "theta", 0.4 / 1.4)
    assert_within(form, "delta", 0.5 / 0.3)
    assert form["case"] == "difficult case III"
    assert form["angle"] == pytest.approx(0.3 * pi, abs=1e-8)


@pytest.mark.seldom
def test_a_linear_change_of_the_states_changes_lengths_alone():
    """theta, delta and the case stay; p11, p21 are as the mean square of one eigenfunction, p12, p22 of the other."""
    r = "(e^2 + f^2)"
    x, y = amplitude("e", "f", f"p + 0.5*{SQUARE} - 0.7*{r}", "0.15")
    equations = {**twisted(f"p/2 + q + 0.3*{SQUARE} - 0.2*{r}", "-1"), "e": x, "f": y}
    matrix = leaning(6)
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    form = point(equations, "NS", "PDNS", box, matrix=matrix, factor="(1 + a/2)", period=T / np.sqrt(0.75)).normal_form
    assert_within(form, "theta", 0.4 / 1.4)
    assert_within(form, "delta", 0.5 / 0.3)
    assert form["p21"] / form["p11"] == pytest.approx(0.5 / 0.3, rel=1e-7)
    pair = matrix @ np.array([0, 0, 0, 0, 1, -1j]) / 2  # of |v| = 1
    assert_within(form, "p22", -0.7 * T / float(np.sum(np.abs(pair) ** 2)))
    assert form["case"] == "difficult case III"


@pytest.mark.parametrize("rate", [0.22, 0.2, 0.15])
def test_two_tori(rate):
    """Two planes that turn by 0.6 pi and 2 pi rate a turn: 0.3 = 2 rate and 0.3 + rate = 1/2 are near-resonant."""
    one, two = "(c^2 + d^2)", "(e^2 + f^2)"
    v = amplitude("c", "d", f"p - 0.3*{one} - 0.2*{two}", "0.3")
    w = amplitude("e", "f", f"p/2 + q - 0.5*{one} - 0.7*{two}", f"{rate}")
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    found = point(dict(zip("cdef", (*v, *w), strict=True)), "NS", "NSNS", box)
    form = found.normal_form
    if rate == 0.15:
        assert form == {}
        return
    for key, value in {"p11": -0.3, "p12": -0.2, "p21": -0.5, "p22": -0.7}.items():
        assert_within(form, key, 2 * T * value)
    assert form["case"] == {0.2: "near-resonant: 2 theta1 + 2 theta2 = 2 pi", 0.22: "simple case II"}[rate]
    assert (form["angle1"], form["angle2"]) == pytest.approx((0.6 * pi, 2 * pi * rate), abs=1e-8)


def test_forced_cycles_have_the_map_over_a_forcing_period():
    """The states at rest of the flip and the pair above, in a plane that turns with the time."""

    r = "(e^2 + f^2)"
    x, y = amplitude("e", "f", f"p + 0.5*{SQUARE} - 0.7*{r}", "0.15")
    plane = {**twisted(f"p/2 + q + 0.3*{SQUARE} - 0.2*{r}", "-1"), "e": x, "f": y}
    turning = {"a": "cos(t)", "b": "sin(t)"}
    equations = {n: re.sub(r"\b[ab]\b", lambda m: turning[m.group()], text) for n, text in plane.items()}
    model = Model("forced", states=dict.fromkeys("cdef", 0.0), parameters={"p": -0.15, "q": -0.17}, equations=equations,
                  forcing={"period": "2*pi"})  # fmt: skip
    orbit, box = contin.periodic_orbit(model, np.zeros((101, 4)), period=T), {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    family = contin.continuation(orbit, "p", box["p"], settings={"stop_at": ("NS",)})
    curve = contin.continuation(family["NS1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": ("PDNS",)})
    form = next(p for p in curve.points if p.type == "PDNS").normal_form
    for key, value in {"p11": 0.3, "p12": -0.4, "p21": 0.5, "p22": -1.4}.items():
        assert_within(form, key, T * value)


def test_a_sign_that_the_mesh_does_not_tell_is_not_stated():
    """Without s |v|^2 in x' the fold has no s."""
    x, y = amplitude("c", "d", "q + 0.2*x - (c^2 + d^2)", "0.3")
    form = fold_form({"x": "p - x^2", "c": x, "d": y}, "LPNS")
    assert "degenerate" in form["case"]
    assert form.get("s", 0) == 0


@pytest.mark.seldom
def test_under_a_condition_it_is_the_same_point():
    """s' = (2 q/3 + r + ..) s with r = q/2: the growth is 7 q/6, and vanishes at the same cycle."""
    turning = {"a": "cos(t)", "b": "sin(t)"}
    plane = {"x": f"p - x^2 + 0.8*{SQUARE}"}
    plane |= twisted(f"2*q/3 + r + 0.25*x + 0.4*x^2 - 0.7*{SQUARE}", "-1")
    equations = {n: re.sub(r"\b[ab]\b", lambda m: turning[m.group()], text) for n, text in plane.items()}
    model = Model("under", states={"x": 0.5, "c": 0.0, "d": 0.0}, parameters={"p": 0.25, "q": -0.1, "r": -0.05},
                  equations=equations, forcing={"period": "2*pi"})  # fmt: skip
    orbit = contin.periodic_orbit(model, np.tile([0.5, 0.0, 0.0], (101, 1)), period=T)
    family = contin.continuation(orbit, "p", (-0.1, 0.3), direction="down", settings={"stop_at": ("LPC",)})
    seed = family["LPC1"].locus(("p", "q"))
    box = {"p": (-0.1, 0.3), "q": (-0.1, 0.1)}
    to_flip = {"stop_at": ("LPPD",)}
    folds = contin.continuation(seed, ("p", "q"), box, settings=to_flip, conditions=["r = q/2"], free=["r"])
    form = next(p for p in folds.points if p.type == "LPPD").normal_form
    assert_within(form, "a", 4.0)
    assert_within(form, "c", 16.0)
    assert_within(form, "b", -0.2 * T * T)
