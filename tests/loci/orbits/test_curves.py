"""Curves of LPC, PD and NS of periodic orbits in two parameters: closed forms and independently computed points."""

from __future__ import annotations

from math import cos, pi

import numpy as np
import pytest

import contin
from contin.continuation.outset import Birth
from contin.model.model import Model
from tests.loci.equilibria.planes import BAUTIN, DOUBLE_HOPF, Plane, amplitude, curves_through
from tests.problems.orbits.test_families import cycles, labels


def curve(point, names, box, **options):
    return contin.continuation(point.locus(names), names, box, **options)


@pytest.fixture(scope="module")
def bautin():
    """w' = (p + q s - s^2 + i) w, s = |w|^2: orbits s = q/2 +- sqrt(q^2/4 + p) fold where p = -q^2/4."""
    growth = "p + q*(x^2 + y^2) - (x^2 + y^2)^2"
    x, y = amplitude("x", "y", growth, "1")
    return Model("bautin", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 1}, equations={"x": x, "y": y})


def test_a_curve_of_folds_that_grows_slowly_from_its_generalised_hopf_point_is_no_curve_that_ends_there():
    """Leslie's predators with saturation: orbits of a hundredth of the states' sizes, and still growing.

    Where it comes to h = 0.42, the fold is the one of the family in s.
    """
    equations = {"N": "N*(1 - N) - P*N/(0.1 + N)", "P": "s*P*(1 - h*P/N)"}
    states, box = {"N": 0.3, "P": 0.37}, {"s": (0.01, 0.4), "h": (0.4, 1.6)}
    at_h = [Model("predators", states=states, parameters={"s": 0.1, "h": h}, equations=equations) for h in (0.8, 0.42)]
    lines = [contin.continuation(predators, "s", box["s"]) for predators in at_h]
    hopf = curve(lines[0]["HB1"], ("s", "h"), box)
    family = contin.continuation(lines[1]["HB1"].switch(), "s", box["s"])
    (folds,) = curves_through(hopf["GH1"], ("s", "h"), box, orbits=True)
    assert folds.ends[-1].text == "h reached 0.4"
    s, h = (np.asarray(folds.columns[name]) for name in ("s", "h"))
    near = np.argsort(abs(h - 0.42))[:4]
    at = sum(s[i] * np.prod([(0.42 - h[j]) / (h[i] - h[j]) for j in near if j != i]) for i in near)
    assert at == pytest.approx(family["LPC1"].values["s"], rel=1e-4)


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
    box = {"c": (4.9, 7.1), "a": (0.05, 0.5)}
    short = curve(family["PD1"], ("c", "a"), box, settings={"step": 5e-3, "max_step": 5e-3})
    assert short.effort["evaluations"] <= 2.5 * short.steps  # one call and one Newton iteration a step; measured 2.1


def test_folds_leave_a_generalised_hopf_point_along_the_parabola():
    hopf = BAUTIN.curve("HB1")
    (folds,) = curves_through(hopf["GH1"], box={"p": (-1, 1), "q": (-1, 1)}, orbits=True)
    p, q = folds.columns["p"], folds.columns["q"]
    assert folds.locus == "LPC"
    assert folds.parent.label == "GH1"
    np.testing.assert_allclose(folds.eigenvalues, 1.0, atol=1e-4)  # of the first row too
    np.testing.assert_allclose(p, -(q**2) / 4, atol=1e-10)
    np.testing.assert_allclose(folds.columns["period"], 2 * pi, rtol=1e-9)
    assert [end.reason for end in folds.ends] == ["start", "bound"]
    assert np.all(q >= 0)


def test_folds_end_at_the_generalised_hopf_point(bautin):
    family = cycles(bautin, "p", (-0.5, 0.5))
    folds = curve(family["LPC1"], ("p", "q"), {"p": (-0.5, 0.5), "q": (-1, 1)})
    reasons = {end.reason for end in folds.ends}
    assert reasons == {"bound", "hopf"}
    assert 0 <= np.min(folds.columns["q"]) < 1e-3
    assert not folds.points


def test_branch_points_of_cycles_that_a_symmetry_forces_are_followed():
    """|w| = 1, z = 0 has the multiplier exp(2 pi (p - q)) in the direction of z -> -z."""
    x, y = amplitude("x", "y", "1 - x^2 - y^2 + 0.1*z^2", "1")
    model = Model(
        "pitchfork", states={"x": 1, "y": 0, "z": 0}, parameters={"p": -0.5, "q": 0.2},
        equations={"x": x, "y": y, "z": "(p - q*(x^2 + y^2))*z - z^3"},
        symmetries={"flip": {"x": "x", "y": "y", "z": "-z"}},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(model), "p", (-0.6, 0.6))
    assert family["BPC1"].values["p"] == pytest.approx(0.2, abs=1e-8)
    points = curve(family["BPC1"], ("p", "q"), {"p": (-0.6, 0.6), "q": (-0.5, 0.5)})
    np.testing.assert_allclose(points.columns["p"], points.columns["q"], atol=1e-9)
    assert [end.reason for end in points.ends] == ["bound", "bound"]
    assert points.columns["q"][[0, -1]] == pytest.approx([-0.5, 0.5])


def test_tori_leave_a_double_hopf_point_along_the_lines_of_the_normal_form():
    """Cycles |w|^2 = p - q/2 with q + p/4 = 2 (p - q/2), and |v|^2 = q + p/4 with p - q/2 = 3 (q + p/4)."""
    hopf = DOUBLE_HOPF.curve("HB1")
    for seed in hopf["HH1"].locus(("p", "q")):
        if seed.problem.locus == "NS":
            assert Birth.of(seed).critical == 4  # multipliers, all of modulus 1
    tori = curves_through(hopf["HH1"], orbits=True)
    slopes = sorted(np.polyfit(branch.columns["p"], branch.columns["q"], 1)[0] for branch in tori)
    assert slopes == pytest.approx(sorted([7 / 8, 1 / 14]), abs=1e-8)
    for branch in tori:
        assert branch.eigenvalues.shape == (len(branch), 4)  # as many as states, of the point itself too
        assert np.isfinite(branch.eigenvalues).all()
        ratio = 2.3 if np.polyfit(branch.columns["p"], branch.columns["q"], 1)[0] > 0.5 else 1 / 2.3
        # to the last Newton correction (1e-9) of orbits that begin with the size zero, where theta is determined least
        np.testing.assert_allclose(branch.columns["cos.theta"], cos(2 * pi * ratio), rtol=0.0, atol=2e-7)


def test_tori_of_frequencies_far_apart_leave_a_double_hopf_point():
    """With frequencies 1 and 7.3 twenty intervals a period have the faster one wrong by more than a first step."""
    fast = amplitude("w2", "w3", "q + 0.25*p - 2*(w0^2 + w1^2) - (w2^2 + w3^2)", "7.3")
    hopf = Plane((*DOUBLE_HOPF.field[:2], *fast), DOUBLE_HOPF.start, DOUBLE_HOPF.at).curve("HB1")
    tori = curves_through(hopf["HH1"], orbits=True, settings={"steps": 6})
    slopes = sorted(np.polyfit(branch.columns["p"], branch.columns["q"], 1)[0] for branch in tori)
    assert slopes == pytest.approx(sorted([7 / 8, 1 / 14]), abs=1e-7)


def test_a_curve_of_folds_turns_round_at_a_generalised_hopf_point_without_a_cusp():
    """A -> B -> C; the amplitude goes through zero there, and the parameters come back the way they went."""
    model = Model(
        "abc", states={"u": 0, "v": 0, "w": 0}, parameters={"D": 0, "a": 1, "be": 1.55, "B": 8, "s": 0.04},
        definitions={"E": "exp(w)"},
        equations={
            "u": "-u + D*(1 - u)*E", "v": "-v + D*E*(1 - u - s*v)",
            "w": "-w - be*w + D*B*E*(1 - u + a*s*v)",
        },
    )  # fmt: skip
    line, mesh = contin.continuation(contin.equilibrium(model), "D", (0, 0.5)), {"intervals": 50}
    family = contin.continuation(line["HB1"].switch(), "D", (0, 0.5), settings=mesh)
    folds = curve(family["LPC2"], ("D", "a"), {"D": (0.2, 0.5), "a": (0.5, 1.5)}, settings=mesh)
    assert [end.reason for end in folds.ends] == ["bound", "hopf"]
    assert labels(folds, "CPC") == []


@pytest.mark.parametrize("names", [("p", "q"), ("q", "p")])
def test_branch_points_at_which_two_families_always_cross_have_a_curve(names):
    """r' = -r (r - p)(r - q): the circles r = p and r = q exist for all p and q, and cross at p = q."""
    growth = "-(r - p)*(r - q)"
    model = Model(
        "crossing", states={"x": 1.2, "y": 0}, parameters={"p": 1.2, "q": 0.8}, definitions={"r": "sqrt(x^2 + y^2)"},
        equations={"x": f"({growth})*x - y", "y": f"x + ({growth})*y"},
    )  # fmt: skip
    angle = np.linspace(0, 2 * np.pi, 101)
    circle = 1.2 * np.column_stack([np.cos(angle), np.sin(angle)])
    box = {"p": (0.3, 2.0), "q": (0.3, 2.0)}
    family = contin.continuation(contin.periodic_orbit(model, circle, period=2 * np.pi), names[0], box[names[0]])
    crossings = contin.continuation(family["BPC1"].locus(), names, box)
    assert [end.reason for end in crossings.ends] == ["bound", "bound"]
    np.testing.assert_allclose(crossings.columns["p"], crossings.columns["q"], rtol=0, atol=1e-9)
    assert np.ptp(crossings.columns["p"]) == pytest.approx(1.7)
    assert crossings.points == ()
