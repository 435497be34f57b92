"""Coefficients at points of codimension two of cycles whose return map is the flow of a known equation.

The circle (a, b) = e(phi) of `test_codim_two` carries further states. A positive factor of the whole field changes
times and no return map; a linear change of the states leaves the map as it is, seen on a section that leans.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import pi, sqrt

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted

SLOW, ROUND = "(1 + a/2)", 2 * pi / sqrt(0.75)  # a factor of the field, and the period with it


def changed(equations: Mapping[str, str], factor: str, matrix: np.ndarray) -> dict[str, str]:
    """factor times the equations, in the states M x."""
    names, inverse = list(equations), np.linalg.inv(matrix)
    old = {name: _weighted(row, names) for name, row in zip(names, inverse, strict=True)}

    def renamed(text: str) -> str:
        return re.sub(r"\b[a-z]\b", lambda found: old.get(found.group(), found.group()), text)

    fields = [renamed(f"{factor}*({text})") for text in equations.values()]
    return {name: _weighted(row, fields) for name, row in zip(names, matrix, strict=True)}


def _weighted(weights: np.ndarray, terms: list[str]) -> str:
    return "(" + " + ".join(f"({w!r})*({t})" for w, t in zip(weights.tolist(), terms, strict=True) if w) + ")"


def point(
    equations: Mapping[str, str], label: str, type_: str, box: Mapping[str, tuple[float, float]], *, factor: str = "1",
    matrix: np.ndarray | None = None, turn: float = 0.0, period: float = 2 * pi, method: str = "collocation",
):  # fmt: skip
    """The first point of a type on the curve of `label` that the circle with the first parameter rising meets.

    turn : of the phase at which the orbit starts.
    """
    whole = {**CIRCLE, **equations}
    matrix = np.eye(len(whole)) if matrix is None else matrix
    angle = turn + np.linspace(0, 2 * pi, 201)
    u = np.zeros((len(angle), len(whole)))
    u[:, 0], u[:, 1] = np.cos(angle), np.sin(angle)
    u = u @ matrix.T
    names = tuple(box)
    model = Model(
        "circle", states=dict(zip(whole, u[0].tolist(), strict=True)), parameters={n: box[n][0] for n in names},
        equations=changed(whole, factor, matrix),
    )  # fmt: skip
    if factor != "1":  # equal times along the slower motion
        speed = 1 + np.cos(angle) / 2
        time = np.concatenate([[0.0], np.cumsum(np.diff(angle) * (1 / speed[1:] + 1 / speed[:-1]) / 2)])
        at = np.linspace(0, time[-1], 201)
        u = np.column_stack([np.interp(at, time, column) for column in u.T])
    orbit = contin.periodic_orbit(model, u, period=period, method=method)
    family = contin.continuation(orbit, names[0], box[names[0]], settings={"stop_at": (label,)})
    seed = next(p for p in family.points if p.type == label)
    branch = contin.continuation(seed.locus(names), names, box, settings={"stop_at": (type_,)})
    return next(p for p in branch.points if p.type == type_)


def leaning(n: int) -> np.ndarray:
    """A matrix of the states' change."""
    matrix = np.eye(n)
    matrix[0, 2], matrix[1, 3 % n], matrix[2, 0], matrix[-1, -1] = 0.3, -0.2, 0.25, 1.5
    return matrix


def assert_within(form: Mapping[str, object], key: str, value: object, least: float = 1e-6) -> None:
    """Within the stated error, which is a small part of the value."""
    error = form["errors"][key]
    found, value = np.asarray(form[key], float), np.asarray(value, float)
    assert np.linalg.norm(found - value) <= error, (found, value, error)
    assert error <= least * max(1.0, float(np.linalg.norm(value)))


FLIP = {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}
TURNED, SLOWED = {"turn": 1.0}, {"factor": SLOW, "period": ROUND}
CHANGES = [{}, SLOWED | TURNED]


@pytest.mark.parametrize("change", CHANGES, ids=["plain", "both"])
def test_degenerate_period_doubling(change):
    """s' = p s + q s^3 + e s^5 in the turning plane, times a factor whose mean over the time is 2 pi / T."""
    equations = twisted(f"p + q*{SQUARE} - 0.7*({SQUARE})^2", "-1")
    form = point(equations, "PD", "GPD", FLIP, **change).normal_form
    assert_within(form, "e", -0.7 * 2 * pi / change.get("period", 2 * pi))
    assert "case" not in form


@pytest.mark.seldom
def test_a_linear_change_of_the_states_changes_the_eigenfunctions_length_alone():
    """|M v|^2 has another mean m over the cycle: c of xi^3 is as 1/m, e and l2 as 1/m^2."""
    matrix = leaning(4)
    equations = twisted(f"p + q*{SQUARE} - 0.7*({SQUARE})^2", "-1")
    half = np.linspace(0, pi, 400, endpoint=False)
    v = np.array([0 * half, 0 * half, np.cos(half), np.sin(half)])
    mean = float(np.mean(np.sum((matrix @ v) ** 2, axis=0)))
    form = point(equations, "PD", "GPD", FLIP, matrix=matrix).normal_form
    assert_within(form, "e", -0.7 / mean**2)
    x, y = amplitude("c", "d", "p + q*(c^2 + d^2) - 0.7*(c^2 + d^2)^2", "0.3")
    v = np.array([0, 0, 1, -1j]) / sqrt(2)
    mean = float(np.sum(np.abs(matrix @ v) ** 2))
    form = point({"c": x, "d": y}, "NS", "CH", FLIP, matrix=matrix).normal_form
    assert_within(form, "l2", -0.7 * 4 / mean**2)  # u = xi v + its conjugate: |c + i d|^2 = 2 |xi|^2


def test_no_sign_is_stated_of_a_coefficient_that_is_zero_to_its_error():
    """s' = p s + q s^3 - s^7: e = 0."""
    form = point(twisted(f"p + q*{SQUARE} - ({SQUARE})^3", "-1"), "PD", "GPD", FLIP).normal_form
    assert abs(form["e"]) <= form["errors"]["e"]
    assert form["case"] == "degenerate"


@pytest.mark.parametrize("k", [0.0, 0.3])
def test_cusp_of_cycles(k):
    """x' = p + q x - c x^3 times (1 + a/2 + k x): with k the period depends on x, and xi is the phase's rate.

    T = 2 pi / sqrt(3/4), dT/dx = -k 2 pi / (3/4)^1.5; xi = -(dT/dx) x / T.
    """
    factor = f"(1 + a/2 + {k}*x)" if k else SLOW
    c = -0.3 * 2 * pi / ROUND
    if k:
        c *= (ROUND / (k * 2 * pi / 0.75**1.5)) ** 2
    angle = np.linspace(0, 2 * pi, 201)
    equations = {n: f"{factor}*({t})" for n, t in {**CIRCLE, "x": "p + q*x - 0.3*x^3"}.items()}
    x = 1.887  # 0.6 + 0.8 x = 0.3 x^3
    model = Model("cusp", states={"a": 1.0, "b": 0.0, "x": x}, parameters={"p": 0.6, "q": 0.8}, equations=equations)
    time = np.concatenate([[0.0], np.cumsum(2 * pi / 200 / (1 + np.cos((angle[1:] + angle[:-1]) / 2) / 2 + k * x))])
    u = np.column_stack([np.cos(angle), np.sin(angle), np.full(201, x)])
    at = np.linspace(0, time[-1], 201)
    u = np.column_stack([np.interp(at, time, column) for column in u.T])
    orbit, box = contin.periodic_orbit(model, u, period=float(time[-1])), {"p": (-1.5, 1), "q": (-0.5, 1.5)}
    family = contin.continuation(orbit, "p", box["p"], settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": ("CPC",)})
    assert_within(folds["CPC1"].normal_form, "c", c, 1e-5)


CUBIC = 0.4, 0.3  # of v |v|^2, real and imaginary
PAIR = {"p": (-0.2, 0.2)}


def resonant(strength: float, power: int) -> dict[str, str]:
    """v' = (p + i q) v - (0.4 + 0.3 i) |v|^2 v + strength e(phi) conj(v)^power: with v = y e(phi / (power + 1))

    y' = (p + i (q - 1/(power + 1))) y - (0.4 + 0.3 i) |y|^2 y + strength conj(y)^power, the phase's own equation.
    """
    x, y = amplitude("c", "d", f"p - {CUBIC[0]}*(c^2 + d^2)", f"(q - {CUBIC[1]}*(c^2 + d^2))")
    re, im = ("(c^2 - d^2)", "(-2*c*d)") if power == 2 else ("(c^3 - 3*c*d^2)", "(d^3 - 3*c^2*d)")
    return {"c": f"{x} + {strength}*(a*{re} - b*{im})", "d": f"{y} + {strength}*(b*{re} + a*{im})"}


PLACES = [{}, {"matrix": leaning(4)} | TURNED]


@pytest.mark.parametrize("change", PLACES, ids=["plain", "leaning"])
def test_one_to_three_resonance(change):
    """Three times round are 6 pi of the equation for y, which is Kuznetsov's normal form: a = Re C / (6 pi B^2)."""
    box = {**PAIR, "q": (0.3, 0.36)}
    form = point(resonant(0.5, 2), "NS", "R3", box, **change).normal_form
    assert_within(form, "a", -CUBIC[0] / (6 * pi * 0.25))
    assert form["case"] == "invariant circle stable"
    if "matrix" not in change:  # y = sqrt(2) xi
        assert abs(complex(*form["B1"])) == pytest.approx(6 * pi * 0.5 * sqrt(2), rel=1e-8)
        assert complex(*form["C1"]) == pytest.approx(-12 * pi * complex(*CUBIC), rel=1e-7)


@pytest.mark.parametrize("change", PLACES, ids=["plain", "leaning"])
def test_one_to_four_resonance(change):
    """Four times round: C1 = 8 pi C, D1 = 8 pi D in y, A0 = C / |D|."""
    box = {**PAIR, "q": (0.22, 0.28)}
    form = point(resonant(0.6, 3), "NS", "R4", box, **change).normal_form
    assert_within(form, "A0", [-CUBIC[0] / 0.6, -CUBIC[1] / 0.6])
    assert form["case"] == "|A0| < 1"


def test_no_ratio_is_stated_over_a_coefficient_that_is_zero():
    """Without the resonant terms: B = 0 of R3, D = 0 of R4."""
    r3 = point(resonant(0.0, 2), "NS", "R3", {**PAIR, "q": (0.3, 0.36)}).normal_form
    r4 = point(resonant(0.0, 3), "NS", "R4", {**PAIR, "q": (0.22, 0.28)}).normal_form
    assert "a" not in r3
    assert "A0" not in r4
    assert "degenerate" in r3["case"]
    assert "degenerate" in r4["case"]


def test_one_to_one_resonance():
    """x' = y, y' = p - x^2 + q y + x y: over 2 pi a = -(2 pi)^2 and b - 2 a = 2 pi."""
    box = {"p": (-0.5, 0.5), "q": (-0.3, 0.4)}
    angle = np.linspace(0, 2 * pi, 201)
    equations = {**CIRCLE, "x": "y", "y": "p - x^2 + q*y + x*y"}
    model = Model("takens", states={"a": 1.0, "b": 0.0, "x": 0.5, "y": 0.0}, parameters={"p": 0.25, "q": -0.3},
                  equations=equations)  # fmt: skip
    u = np.column_stack([np.cos(angle), np.sin(angle), np.full(201, 0.5), np.zeros(201)])
    orbit = contin.periodic_orbit(model, u, period=2 * pi)
    family = contin.continuation(orbit, "p", box["p"], direction="down", settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), box, settings={"stop_at": ("R1",)})
    form = folds["R11"].normal_form
    a, b = -((2 * pi) ** 2), 2 * pi - 2 * (2 * pi) ** 2
    assert_within(form, "a", a, 1e-5)
    assert_within(form, "b", b, 1e-5)
    assert form["s"] == -1


def test_forced_cycles_have_the_map_over_a_forcing_period():
    """The states at rest of s' = p s + q s^3 - 0.7 s^5 in a plane that turns with the time: no section, no phase."""
    turning = {"a": "cos(t)", "b": "sin(t)"}
    plane = twisted(f"p + q*{SQUARE} - 0.7*({SQUARE})^2", "-1")
    equations = {n: re.sub(r"\b[ab]\b", lambda m: turning[m.group()], text) for n, text in plane.items()}
    model = Model("forced", states={"c": 0.0, "d": 0.0}, parameters={"p": -0.3, "q": -0.5}, equations=equations,
                  forcing={"period": "2*pi"})  # fmt: skip
    orbit = contin.periodic_orbit(model, np.zeros((101, 2)), period=2 * pi)
    family = contin.continuation(orbit, "p", FLIP["p"], settings={"stop_at": ("PD",)})
    curve = contin.continuation(family["PD1"].locus(("p", "q")), ("p", "q"), FLIP, settings={"stop_at": ("GPD",)})
    assert_within(curve["GPD1"].normal_form, "e", -0.7)


def test_one_to_two_resonance_on_either_curve_through_it():
    """s' = z, z' = p s + q z + C s^3 + D s^2 z in the turning plane: over 4 pi C1 = (4 pi)^2 C, D1 = 4 pi D."""
    box = {"p": (-0.15, 0.15), "q": (-0.15, 0.12)}
    equations = twisted("0", f"q - 0.8*{SQUARE}", along_by_z="1", across_by_s=f"p - 0.5*{SQUARE}")
    flip = point(equations, "PD", "R2", box)
    (seed,) = flip.locus(("p", "q"))
    tori = contin.continuation(seed, ("p", "q"), box, settings={"stop_at": ("R2",)})
    for form in (flip.normal_form, tori["R21"].normal_form):
        assert_within(form, "C1", -0.5 * (4 * pi) ** 2, 1e-5)
        assert_within(form, "D1", -0.8 * 4 * pi, 1e-5)
        assert form["case"] == "C1 < 0, D1 < 0"


@pytest.mark.seldom
def test_a_section_across_the_cycle_and_a_forcing_period_give_the_same():
    """Predator and prey in seasons (Kuznetsov, Muratori and Rinaldi, Bull. Math. Biol. 54 (1992) 15).

    They are forced by the time, or by an oscillator whose cycle is the unit circle: one return map has a section.
    """

    def forms(season: str, more: dict[str, str], start: dict[str, float], samples: np.ndarray):
        grazed = f"4*pi*x*y/(b*(1 + E*{season}) + x)"
        equations = {"x": f"2*pi*x*(1 - x) - {grazed}", "y": f"-2*pi*y + {grazed}", **more}
        model = Model("year", states={"x": 0.5, "y": 0.25, **start}, parameters={"b": 0.5, "E": 0.05},
                      equations=equations, forcing=None if more else {"period": "1"})  # fmt: skip
        u = np.hstack([np.full((101, 2), (0.5, 0.25)), samples])
        orbit = contin.periodic_orbit(model, u, period=1.0)
        family = contin.continuation(orbit, "E", (0.0, 0.7), settings={"stop_at": ("PD",)})
        box = {"b": (0.3, 0.55), "E": (0.0, 0.7)}
        curve = contin.continuation(family["PD1"].locus(("b", "E")), ("b", "E"), box)
        return curve["GPD1"].normal_form, curve["R21"].normal_form

    angle = np.linspace(0, 2 * pi, 101)
    circle = {"u": "u - 2*pi*v - u*(u^2 + v^2)", "v": "v + 2*pi*u - v*(u^2 + v^2)"}
    own = forms("u", circle, {"u": 1.0, "v": 0.0}, np.column_stack([np.cos(angle), np.sin(angle)]))
    forced = forms("cos(2*pi*t)", {}, {}, np.empty((101, 0)))
    for one, other, keys in zip(own, forced, (("e",), ("C1", "D1")), strict=True):
        for key in keys:
            assert abs(one[key] - other[key]) <= one["errors"][key] + other["errors"][key] < 1e-5 * abs(one[key])
    assert own[1]["case"] == forced[1]["case"] == "C1 > 0, D1 < 0"


def test_slow_and_fast_states_beside_it_change_nothing():
    """Two decoupled states, one in units of 1e6."""
    equations = twisted(f"p + q*{SQUARE} - 0.7*({SQUARE})^2", "-1") | {"e": "-0.1*e", "f": "-20*f + 1e6*a"}
    assert_within(point(equations, "PD", "GPD", FLIP).normal_form, "e", -0.7)
