"""Points of codimension two on curves of orbits, where the Poincare map is the flow of a known amplitude equation.

The unit circle of (a, b), run through once in 2 pi, carries further states. Untwisted ones obey an equation of their
own: their map is its flow over 2 pi. A plane (c, d) that turns by half a turn in a period, with coordinates s, z in the
turning directions e(phi/2) and its normal, carries the equations of s and z: their map is -1 times that flow.
"""

from __future__ import annotations

from math import cos, pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude

CIRCLE = {"a": "a*(1 - a^2 - b^2) - b", "b": "b*(1 - a^2 - b^2) + a"}
ALONG = ("((1 + a)*c + b*d)/2", "(b*c + (1 - a)*d)/2")  # s e(phi/2), where (a, b) = e(phi)
ACROSS = ("((1 - a)*c - b*d)/2", "(-b*c + (1 + a)*d)/2")  # z times the normal of e(phi/2)
ALONG_BY_Z = ("(-b*c + (1 + a)*d)/2", "(-(1 - a)*c + b*d)/2")  # z e(phi/2)
ACROSS_BY_S = ("(-b*c - (1 - a)*d)/2", "((1 + a)*c + b*d)/2")  # s times the normal
SQUARE = "((1 + a)*c^2 + 2*b*c*d + (1 - a)*d^2)/2"  # s^2


def twisted(along_by_s: str, across_by_z: str, along_by_z: str = "0", across_by_s: str = "0") -> dict[str, str]:
    """s' = along_by_s s + along_by_z z, z' = across_by_s s + across_by_z z in the turning plane."""
    factors = (along_by_s, across_by_z, along_by_z, across_by_s)
    vectors = (ALONG, ACROSS, ALONG_BY_Z, ACROSS_BY_S)
    terms = [[f"({f})*({v[k]})" for f, v in zip(factors, vectors, strict=True)] for k in (0, 1)]
    return {"c": " + ".join(["-d/2", *terms[0]]), "d": " + ".join(["c/2", *terms[1]])}


METHODS = pytest.mark.parametrize("method", ["collocation", "shooting"])
ONE_BY_DEFAULT = pytest.mark.parametrize("method", ["collocation", pytest.param("shooting", marks=pytest.mark.long)])


def orbit_on_circle(
    equations: dict[str, str], parameters: dict[str, float], x: float = 0.0, method: str = "collocation"
):
    """The unit circle with the first further state at x and the others at 0, closed by Newton."""
    states = {name: 1.0 if name == "a" else 0.0 for name in (*CIRCLE, *equations)}
    model = Model("circle", states=states, parameters=parameters, equations={**CIRCLE, **equations})
    angle = np.linspace(0, 2 * pi, 101)
    u = np.zeros((101, len(states)))
    u[:, 0], u[:, 1], u[:, 2] = np.cos(angle), np.sin(angle), x
    return contin.periodic_orbit(model, u, period=2 * pi, method=method)


def curve(
    equations: dict[str, str], names: tuple[str, str], box: dict[str, tuple[float, float]], label: str,
    method: str = "collocation",
):  # fmt: skip
    """The curve through the first such point of the circle with the first parameter rising through the box."""
    orbit = orbit_on_circle(equations, {name: box[name][0] for name in names}, method=method)
    family = contin.continuation(orbit, names[0], box[names[0]], settings={"stop_at": (label,)})
    point = next(p for p in family.points if p.type == label)
    return contin.continuation(point.locus(names), names, box)


def assert_only(branch, wanted: dict[str, tuple[float, ...]], name: str) -> None:
    found = {}
    for p in branch.points:
        found.setdefault(p.type, []).append(p.values[name])
    assert set(found) == set(wanted)
    for type_, values in wanted.items():
        assert sorted(found[type_]) == pytest.approx(sorted(values), abs=1e-7)
    for p in branch.points:  # an empty normal form has a note
        assert p.normal_form or any(note.startswith(f"{p.type}: ") for note in branch.notes)


@ONE_BY_DEFAULT
def test_period_doubling_is_degenerate_where_its_cubic_coefficient_vanishes(method):
    """s' = p s + q s^3 - s^5, z' = -z: PD at p = 0 with c = q, the eigenfunction having |s| = 1."""
    equations = twisted(f"p + q*{SQUARE} - ({SQUARE})^2", "-1")
    flips = curve(equations, ("p", "q"), {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}, "PD", method)
    np.testing.assert_allclose(flips.columns["p"], 0, atol=1e-9)
    assert_only(flips, {"GPD": (0.0,)}, "q")
    assert [end.reason for end in flips.ends] == ["bound", "bound"]
    (seed,) = flips["GPD1"].locus(("p", "q"))  # doubled orbits, s^2 = q/2, fold at p = -q^2/4, q > 0
    folds = contin.continuation(seed, ("p", "q"), {"p": (-0.3, 0.4), "q": (-0.5, 0.7)})
    assert folds.locus == "LPC"
    np.testing.assert_allclose(folds.columns["period"], 4 * pi, rtol=1e-8)
    np.testing.assert_allclose(folds.columns["p"], -(folds.columns["q"] ** 2) / 4, atol=1e-8)
    assert folds.columns["q"].max() == pytest.approx(0.7)
    assert sorted(end.reason for end in folds.ends) == ["bound", "joined"]


def test_folds_of_doubled_orbits_end_at_the_degenerate_period_doubling():
    """s' = p s + q s^3 - s^5: doubled orbits with p + q s^2 = s^4 fold at p = -q^2/4, s^2 = q/2, which is 0 at GPD."""
    equations = twisted(f"p + q*{SQUARE} - ({SQUARE})^2", "-1")
    orbit = orbit_on_circle(equations, {"p": -0.3, "q": 0.5})
    family = contin.continuation(orbit, "p", (-0.3, 0.4), settings={"stop_at": ("PD",)})
    doubled = contin.continuation(family["PD1"].switch(), "p", (-0.3, 0.4), settings={"stop_at": ("LPC",)})
    folds = contin.continuation(doubled["LPC1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-1, 0.7)})
    np.testing.assert_allclose(folds.columns["p"], -(folds.columns["q"] ** 2) / 4, atol=1e-8)
    assert [p.type for p in folds.points] == []
    assert sorted(end.reason for end in folds.ends) == ["bound", "joined"]
    assert np.abs(folds.columns["q"]).min() < 0.1


def test_no_cusp_is_labelled_where_folds_of_doubled_forced_orbits_end():
    """The parameters turn at GPD: states much larger than their metric at the start hid that the halves are one."""
    equations = {"x": "y", "y": "-0.298*y + 0.587*x - 0.605*x^3 + q*cos(w*t)"}
    model = Model(
        "duffing", states={"x": 0.1, "y": 0.0}, parameters={"w": 0.996, "q": 0.05}, equations=equations,
        forcing={"period": "2*pi/w"},
    )  # fmt: skip
    names, box = ("q", "w"), {"q": (0.02, 8.0), "w": (0.3, 2.5)}
    line = contin.continuation(contin.periodic_orbit(model), "q", (0.02, 8.0), settings={"stop_at": ("PD",)})
    doubled = contin.continuation(line["PD1"].switch(), "q", (0.02, 8.0), settings={"stop_at": ("LPC",)})
    folds = contin.continuation(doubled["LPC1"].locus(), names, box)
    assert folds.points == ()
    assert sorted(end.reason for end in folds.ends) == ["bound", "joined"]
    flips = contin.continuation(line["PD1"].locus(), names, box)
    last = [(folds.columns["q"][row], folds.columns["w"][row]) for row in (0, -1) if folds.columns["w"][row] > 1.0]
    assert last[0] == pytest.approx([flips["GPD1"].values[name] for name in names], rel=1e-3)


@ONE_BY_DEFAULT
def test_torus_bifurcation_is_degenerate_where_its_cubic_coefficient_vanishes(method):
    """v' = (p + i t + q |v|^2 - |v|^4) v: NS at p = 0 with Re d = q."""
    x, y = amplitude("c", "d", "p + q*(c^2 + d^2) - (c^2 + d^2)^2", "0.3")
    tori = curve({"c": x, "d": y}, ("p", "q"), {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}, "NS", method)
    np.testing.assert_allclose(tori.columns["p"], 0, atol=1e-9)
    assert_only(tori, {"CH": (0.0,)}, "q")


@ONE_BY_DEFAULT
def test_resonances_of_a_torus_bifurcation_lie_at_rational_turns(method):
    x, y = amplitude("c", "d", "p - (c^2 + d^2)", "(q + 0.05*(c^2 + d^2))")
    tori = curve({"c": x, "d": y}, ("p", "q"), {"p": (-0.3, 0.4), "q": (0.2, 0.4)}, "NS", method)
    assert_only(tori, {"R4": (1 / 4,), "R3": (1 / 3,)}, "q")
    assert tori["R31"].values["cos.theta"] == pytest.approx(cos(2 * pi / 3), abs=1e-9)


@pytest.mark.seldom
def test_torus_bifurcation_is_degenerate_beside_and_at_a_strong_resonance():
    """v' = (p + i q + (q - r) |v|^2 - |v|^4) v: Re d = q - r; R4 at q = 1/4, in one step with CH at q = r."""
    for r in (0.252, 0.25):
        x, y = amplitude("c", "d", f"p + (q - {r})*(c^2 + d^2) - (c^2 + d^2)^2", "q")
        tori = curve({"c": x, "d": y}, ("p", "q"), {"p": (-0.3, 0.4), "q": (0.18, 0.31)}, "NS")
        assert_only(tori, {"R4": (0.25,), "CH": (r,)}, "q")


@ONE_BY_DEFAULT
def test_tori_meet_period_doublings(method):
    """s' = (p/2 + q - s^2) s in the turning plane, v' = (p + 0.3 i - |v|^2) v: PD at q = -p/2, NS at p = 0."""
    x, y = amplitude("e", "f", "p - (e^2 + f^2)", "0.3")
    equations = {**twisted(f"p/2 + q - {SQUARE}", "-1"), "e": x, "f": y}
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    tori = curve(equations, ("p", "q"), box, "NS", method)
    np.testing.assert_allclose(tori.columns["p"], 0, atol=1e-9)
    assert_only(tori, {"PDNS": (0.0,)}, "q")
    flips = through(tori["PDNS1"], "PD", box)
    np.testing.assert_allclose(flips.columns["p"], -2 * flips.columns["q"], atol=1e-8)
    assert_only(flips, {"PDNS": (0.0,)}, "q")


@ONE_BY_DEFAULT
def test_two_curves_of_tori_cross(method):
    """v' = (p + 0.3 i - |v|^2) v and w' = (p/2 + q + 0.2 i - |w|^2) w: NS at p = 0 and at q = -p/2."""
    v, w = amplitude("c", "d", "p - (c^2 + d^2)", "0.3"), amplitude("e", "f", "p/2 + q - (e^2 + f^2)", "0.2")
    box = {"p": (-0.15, 0.2), "q": (-0.17, 0.15)}
    tori = curve({"c": v[0], "d": v[1], "e": w[0], "f": w[1]}, ("p", "q"), box, "NS", method)
    np.testing.assert_allclose(tori.columns["p"], 0, atol=1e-9)
    assert_only(tori, {"NSNS": (0.0,)}, "q")
    others = through(tori["NSNS1"], "NS", box)
    np.testing.assert_allclose(others.columns["p"], -2 * others.columns["q"], atol=1e-8)
    np.testing.assert_allclose(others.columns["cos.theta"], cos(0.4 * pi), atol=1e-9)
    assert_only(others, {"NSNS": (0.0,)}, "q")


@ONE_BY_DEFAULT
def test_two_period_doublings_meet_at_r2_as_in_the_bogdanov_takens_form(method):
    """s' = z, z' = p s + q z - s^3: multipliers -exp(2 pi l), l^2 - q l - p = 0; PD at p = 0, both at q = 0."""
    equations = twisted("0", "q", along_by_z="1", across_by_s=f"p - {SQUARE}")
    box = {"p": (-0.15, 0.15), "q": (-0.15, 0.12)}
    flips = curve(equations, ("p", "q"), box, "PD", method)
    np.testing.assert_allclose(flips.columns["p"], 0, atol=1e-8)
    assert_only(flips, {"R2": (0.0,)}, "q")
    tori = through(flips["R21"], "NS", box)  # l = +-sqrt(p), imaginary for p < 0
    np.testing.assert_allclose(tori.columns["q"], 0, atol=1e-8)
    p, neutral = tori.columns["p"], tori.columns["neutral"]
    np.testing.assert_allclose(tori.columns["cos.theta"][p < 0], -np.cos(2 * pi * np.sqrt(-p[p < 0])), atol=1e-7)
    assert np.all(neutral[p > 1e-6])
    assert not np.any(neutral[p < -1e-6])
    back = through(tori["R21"], "PD", box)
    np.testing.assert_allclose(back.columns["p"], 0, atol=1e-8)


def through(point, type_: str, box: dict[str, tuple[float, float]]):
    """The curve of another type through a point, which is the start of both its arms."""
    (seed,) = point.locus(("p", "q"))
    branch = contin.continuation(seed, ("p", "q"), box)
    assert branch.locus == type_
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    return branch


@pytest.mark.seldom
def test_folds_meet_further_critical_multipliers():
    """x' = p - x^2 beside a state with the multiplier exp(2 pi q), a turning plane, or a pair."""
    pair = amplitude("c", "d", "q + 0.2*x - (c^2 + d^2)", "0.3")
    folds = folds_of({"x": "p - x^2", "c": pair[0], "d": pair[1]})
    assert_only(folds, {"LPNS": (0.0,)}, "q")
    box = {"p": (-0.5, 0.5), "q": (-0.13, 0.13)}
    tori = through(folds["LPNS1"], "NS", box)  # q + x/5 = 0, x^2 = p
    np.testing.assert_allclose(tori.columns["p"], 25 * tori.columns["q"] ** 2, atol=1e-7)
    assert_only(tori, {"LPNS": (0.0,)}, "q")
    flips = twisted(f"q + 0.2*x - {SQUARE}", "-1")
    folds = folds_of({"x": "p - x^2", **flips})
    assert_only(folds, {"LPPD": (0.0,)}, "q")
    doublings = through(folds["LPPD1"], "PD", box)
    np.testing.assert_allclose(doublings.columns["p"], 25 * doublings.columns["q"] ** 2, atol=1e-7)
    takens = folds_of({"x": "y", "y": "p - x^2 + q*y + x*y"})
    assert_only(takens, {"R1": (0.0,)}, "q")
    tori = through(takens["R11"], "NS", {"p": (-0.5, 0.25), "q": (-0.2, 0.2)})  # q + x = 0, x^2 = p, l^2 = -2 x
    p, q = tori.columns["p"], tori.columns["q"]
    np.testing.assert_allclose(p, q**2, atol=1e-7)
    np.testing.assert_allclose(tori.columns["cos.theta"][q < 0], np.cos(2 * pi * np.sqrt(-2 * q[q < 0])), atol=1e-6)


def folds_of(equations: dict[str, str]):
    """The curve p = 0 of folds of x = +-sqrt(p), from the family at q = -0.3 followed down in p."""
    orbit = orbit_on_circle(equations, {"p": 0.25, "q": -0.3}, 0.5)
    family = contin.continuation(orbit, "p", (-0.5, 0.5), direction="down", settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), {"p": (-0.5, 0.5), "q": (-0.3, 0.4)})
    np.testing.assert_allclose(folds.columns["p"], 0, atol=1e-8)
    return folds


@METHODS
@pytest.mark.seldom
def test_two_curves_of_folds_meet_in_a_cusp(method):
    """x' = p + q x - x^3: folds 27 p^2 = 4 q^3."""
    orbit = orbit_on_circle({"x": "p + q*x - x^3"}, {"p": 0.6, "q": 0.8}, 1.16, method)
    family = contin.continuation(orbit, "p", (-1, 1), settings={"stop_at": ("LPC",)})
    folds = contin.continuation(family["LPC1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-0.5, 1.5)})
    np.testing.assert_allclose(27 * folds.columns["p"] ** 2, 4 * folds.columns["q"] ** 3, atol=1e-7)
    assert [p.type for p in folds.points] == ["CPC"]
    assert folds["CPC1"].values["q"] == pytest.approx(0, abs=1e-7)


@METHODS
def test_doubled_orbits_leave_a_period_doubling_along_any_parameter(method):
    """s' = (p + q - s^2) s: doubled orbits with s^2 = p + q, followed from q = 0.1 with p fixed at -0.1."""
    orbit = orbit_on_circle(twisted(f"p + q - {SQUARE}", "-1"), {"p": -0.3, "q": 0.1}, method=method)
    family = contin.continuation(orbit, "p", (-0.3, 0.3), settings={"stop_at": ("PD",)})
    doubled = contin.continuation(family["PD1"].switch("q"), "q", (0.0, 0.5))
    q = doubled.columns["q"]
    np.testing.assert_allclose(doubled.columns["period"], 4 * pi, rtol=1e-9)
    np.testing.assert_allclose(doubled.columns["c.max"] ** 2, q - 0.1, atol=1e-6)
    assert q[-1] == pytest.approx(0.5)


def test_tori_leave_a_zero_hopf_point_as_the_planar_system_says():
    """w' = w (q + z - z^2/5 + i), z' = p - z^2 - |w|^2: the planar system has centres z = q = 0, p = |w|^2, of the rate
    sqrt(2 p), so that the angle of the tori is 2 pi sqrt(2 p): R4 at p = 1/32, R3 at p = 1/18.
    """
    x, y = amplitude("x", "y", "q + z - z^2/5", "1")
    model = Model(
        "zero-hopf", states={"x": 0.0, "y": 0.0, "z": 0.7}, parameters={"p": 0.5, "q": 0.1},
        equations={"x": x, "y": y, "z": "p - z^2 - x^2 - y^2"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1, 1))
    hopf = contin.continuation(line["HB1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-1, 1)})
    (seed,) = [s for s in hopf["ZH1"].locus(("p", "q")) if s.problem.locus == "NS"]
    tori = contin.continuation(seed, ("p", "q"), {"p": (-0.1, 0.06), "q": (-1, 1)})
    np.testing.assert_allclose(tori.columns["q"], 0, atol=1e-8)
    np.testing.assert_allclose(tori.columns["x.max"] ** 2, tori.columns["p"], atol=1e-6)
    assert_only(tori, {"R4": (1 / 32,), "R3": (1 / 18,)}, "p")
    assert [end.reason for end in tori.ends] == ["start", "bound"]
    assert tori.eigenvalues.shape == (len(tori), 3)  # as many as states, of the point itself too
