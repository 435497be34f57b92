"""Points of one codimension more on curves of folds and branch points of boundary-value problems, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model

COARSE = {"intervals": 3, "points": 3, "max_step": 0.3}  # constants are exact on any mesh
ENDS = ["u(start) = 0", "u(end) = 0"]


def bvp(equations, conditions, parameters, **more):
    return Model(
        "m", kind="bvp", states=dict.fromkeys(equations, 0), equations=equations, conditions=conditions,
        parameters=parameters, **more,
    )  # fmt: skip


def constant(condition, parameters):
    """u' = 0 with one condition on the constant: an algebraic equation that is solved as a boundary-value problem."""
    return bvp({"u": "0"}, [condition], parameters)


@pytest.fixture(scope="module")
def beam():
    """u'' + lam u + a u^2 + b u^3 = 0: every n-th mode branches at lam = (n pi)^2."""
    model = bvp({"u": "v", "v": "-lam*u - a*u^2 - b*u^3"}, ENDS, {"lam": 5.0, "a": 1.0, "b": 1.0})
    return contin.continuation(boundary_guess(model), "lam", (5.0, 45.0), settings={"intervals": 6})


def test_the_second_mode_is_a_degenerate_pitchfork_at_a_ratio_of_its_coefficients(beam):
    """b30 of sin 2 pi x is 9 b/4 - 5 a^2/(8 pi^2); h = -a/(4 pi^2) - a cos 4 pi x/(12 pi^2) + a cos 2 pi x/(3 pi^2)."""
    box, settings = {"lam": (5, 60), "b": (-0.5, 2)}, {"intervals": 6, "stop_at": ["DP"]}
    found = contin.continuation(beam["BP2"].locus(("lam", "b")), ("lam", "b"), box, direction="down", settings=settings)
    point = found["DP1"]
    assert point.values["b"] == pytest.approx(5 / (18 * np.pi**2), rel=1e-5)
    assert abs(point.values["lam"] - 4 * np.pi**2) <= point.error
    assert point.normal_form["criticality"] == "degenerate"


def test_the_first_mode_is_a_pitchfork_where_its_quadratic_coefficient_vanishes(beam):
    """b20 is 2 a times the integral of sin^3. The branch point is u = 1e-33, whose metric is that of its branch."""
    box, settings = {"lam": (5, 20), "a": (-0.5, 2)}, {"intervals": 6, "stop_at": ["DP"]}
    found = contin.continuation(beam["BP1"].locus(("lam", "a")), ("lam", "a"), box, direction="down", settings=settings)
    assert found["DP1"].values["a"] == pytest.approx(0.0, abs=1e-9)
    assert found["DP1"].normal_form["kind"] == "pitchfork"


@pytest.mark.parametrize(
    ("power", "kind"), [pytest.param(1, "transcritical", marks=pytest.mark.long), (2, "pitchfork")]
)
def test_folds_touch_the_branch_points_where_these_are_degenerate(power, kind):
    """u (p + q u^k - u^2k): branch points at p = 0, folds at p = -q^2/4; of pitchforks these end there."""
    model = constant(f"u(start)*(p + q*u(end)^{power} - u(start)^{2 * power}) = 0", {"p": -0.1, "q": 0.5})
    line = contin.continuation(boundary_guess(model), "p", (-0.1, 0.1), settings=COARSE)
    assert line["BP1"].normal_form["kind"] == kind
    fork = contin.continuation(line["BP1"].switch(), "p", (-1, 1), settings=COARSE)
    names, box = ("p", "q"), {"p": (-1, 1), "q": (-0.1, 1)}
    stop = COARSE | {"stop_at": ["DP"]}
    points = contin.continuation(line["BP1"].locus(names), names, box, settings=stop)
    folds = contin.continuation(fork["LP1"].locus(names), names, box, direction="up", settings=COARSE)
    for curve in (points, folds):
        assert [p.type for p in curve.points] == ["DP"]
        assert [curve["DP1"].values[name] for name in names] == pytest.approx([0.0, 0.0], abs=1e-8)
    assert [end.reason for end in folds.ends] == ["start", "joined" if kind == "pitchfork" else "bound"]


@pytest.mark.long
def test_a_swallowtail_on_a_curve_of_cusps():
    """u^4 + c u^2 + b u + a: cusps at c = -6 u^2, a swallowtail at 0."""
    names = ("a", "b", "c")
    model = constant("a + b*u(start) + c*u(end)^2 + u(start)^4 = 0", {"a": -0.01, "b": -0.01, "c": -0.1})
    stop = COARSE | {"stop_at": ["CP", "LP", "SW"]}
    line = contin.continuation(boundary_guess(model, {"u": 0.4}), "a", (-0.1, 0.1), direction="up", settings=stop)
    box = {"a": (-0.1, 0.1), "b": (-0.2, 0.2), "c": (-0.4, 0.1)}
    folds = contin.continuation(line["LP1"].locus(("a", "b")), ("a", "b"), box, settings=stop)
    found = contin.continuation(folds["CP1"].locus(names), names, box, settings=stop)
    assert [p.type for p in found.points] == ["SW"]
    assert [found["SW1"].values[name] for name in names] == pytest.approx([0, 0, 0], abs=1e-6)


def test_two_modes_that_vanish_at_once_are_a_note():
    """The folds of Bratu's problem, beside w'' + mu w = w^3, which branches at mu = pi^2."""
    model = bvp(
        {"u": "v", "v": "-lam*exp(u)", "w": "z", "z": "-mu*w + w^3"}, [*ENDS, "w(start) = 0", "w(end) = 0"],
        {"lam": 3.0, "mu": 9.0},
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model), "lam", (2.9, 4.0), direction="up", settings={"stop_at": ["LP"]})
    box = {"lam": (3, 4), "mu": (9, 11)}
    found = contin.continuation(line["LP1"].locus(("lam", "mu")), ("lam", "mu"), box, settings={"max_step": 1.0})
    assert not found.points
    assert [note for note in found.notes if "two dimensions near lam = 3.51383" in note]


def test_branch_points_that_nothing_forces_are_said_to_be_unfolded():
    """(u - s)(p - u - s) + r - s^2 at r off s^2."""
    model = constant("(u(start) - s)*(p - u(end) - s) + r - s^2 = 0", {"p": 0, "r": 0.25, "s": 0.5})
    line = contin.continuation(boundary_guess(model, {"u": 0.5}), "p", (-2, 3), settings=COARSE)
    found = contin.continuation(line["BP1"].locus(("p", "r")), ("p", "r"), {"p": (-2, 3), "r": (0, 1)}, settings=COARSE)
    assert any("nothing forces these branch points" in note for note in found.notes)


@pytest.mark.long
@pytest.mark.parametrize(("condition", "r", "p"), [
    ("r + p*u(start) + s*u(end)^2 + u(start)^3 = 0", 0.0, -0.2), ("r + s*p + p^3 + u(start)^2 = 0", -0.054, -0.5),
])  # fmt: skip
def test_generic_branch_points_whose_reduced_equation_is_degenerate(condition, r, p):
    """u = p = r = 0 for every s: b20 = 2 s; and u = 0, s = -3 p^2, r = 2 p^3: a02 b20 - b11^2 = 12 p."""
    names = ("p", "r", "s")
    model = constant(condition, {"p": p, "r": r, "s": -0.27})
    stop = COARSE | {"stop_at": ["BP", "DBP"]}
    line = contin.continuation(boundary_guess(model, {"u": 0.2}), "p", (-0.6, 0.3), direction="up", settings=stop)
    box = {"p": (-1, 1), "r": (-1, 1), "s": (-0.5, 0.1)}
    found = contin.continuation(line["BP1"].locus(names), names, box, settings=stop)
    assert {p.type for p in found.points} == {"DBP"}
    assert [found["DBP1"].values[name] for name in names] == pytest.approx([0, 0, 0], abs=1e-8)


@pytest.mark.seldom
def test_degenerate_pitchforks_in_three_parameters(beam):
    """Those of the second mode: lam = 4 pi^2, b = 5 a^2/(18 pi^2)."""
    box, settings = {"lam": (5, 60), "b": (-0.5, 2)}, {"intervals": 6, "stop_at": ["DP"]}
    curve = contin.continuation(beam["BP2"].locus(("lam", "b")), ("lam", "b"), box, direction="down", settings=settings)
    names, wide = ("lam", "b", "a"), {"lam": (5, 60), "b": (-0.5, 2), "a": (0.5, 2)}
    found = contin.continuation(curve["DP1"].locus(names), names, wide, settings={"intervals": 6})
    lam, b, a = (found.columns[name] for name in names)
    assert np.allclose(lam, 4 * np.pi**2, rtol=1e-6)
    assert np.allclose(b, 5 * a**2 / (18 * np.pi**2), rtol=1e-5)
    assert {end.reason for end in found.ends} == {"bound"}


@pytest.mark.seldom
def test_degenerate_transcritical_points_in_three_parameters():
    """u (p - c^2 + (q - c) u + u^2): at p = c^2, q = c."""
    model = constant("u(start)*(p - c^2 + (q - c)*u(end) + u(start)^2) = 0", {"p": 0.5, "q": 1.5, "c": 1.0})
    line = contin.continuation(boundary_guess(model), "p", (0.5, 1.5), settings=COARSE)
    box = {"p": (0.5, 1.5), "q": (0.0, 2.0)}
    curve = contin.continuation(line["BP1"].locus(("p", "q")), ("p", "q"), box, settings=COARSE)
    names, wide = ("p", "q", "c"), {"p": (0.0, 4.0), "q": (-2.0, 2.0), "c": (-0.6, 1.6)}
    found = contin.continuation(curve["DP1"].locus(names), names, wide, settings=COARSE)
    p, q, c = (found.columns[name] for name in names)
    assert np.allclose(p, c**2, atol=1e-8)
    assert np.allclose(q, c, atol=1e-8)
    assert np.ptp(c) > 2.0  # past c = 0, where p turns
