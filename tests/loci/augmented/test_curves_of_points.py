"""Curves of equilibria in three parameters, under conditions, and of extrema, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

WIDE = (-40.0, 40.0)


def model(equations, parameters, kind="flow", **more):
    return Model("m", kind=kind, states=dict.fromkeys(equations, 0), parameters=parameters, equations=equations, **more)


def line(system, start, parameter, bounds, **options):
    return contin.continuation(contin.equilibrium(system, start), parameter, bounds, **options)


def quartic():
    """x^4 + c x^2 + b x + a: cusps at a = -3 x^4, b = 8 x^3, c = -6 x^2, a swallowtail at 0."""
    return model({"x": "a + b*x + c*x^2 + x^4"}, {"a": -3, "b": -3, "c": -1})


def test_a_curve_of_cusps_and_its_swallowtail():
    folds = contin.continuation(
        line(quartic(), {"x": 2}, "a", (-40, 4))["LP1"].locus(("a", "b")), ("a", "b"), {"a": WIDE, "b": WIDE}
    )
    names = ("a", "b", "c")
    cusps = contin.continuation(folds["CP1"].locus(names), names, {"a": WIDE, "b": WIDE, "c": (-3, 3)})
    x = cusps.columns["x"]
    for name, exact in {"a": -3 * x**4, "b": 8 * x**3, "c": -6 * x**2}.items():
        assert np.allclose(cusps.columns[name], exact, atol=1e-9)
    assert [p.type for p in cusps.points] == ["SW"]
    assert cusps.parameters == names
    assert cusps.locus == "CP"
    assert [end.reason for end in cusps.ends] == ["bound", "bound"]
    assert all(abs(cusps["SW1"].values[name]) < 1e-8 for name in names)
    assert cusps["SW1"].normal_form["c"] == 0.0  # by the point's condition: what rounding leaves of it is its error
    assert 0.0 < cusps["SW1"].normal_form["errors"]["c"] < 1e-8


def test_a_curve_of_bogdanov_takens_points_with_its_degenerate_one():
    """y' = m + n y + c x^2 + x y + x^3: BT at m = n = 0 with a = c and b = 1."""
    system = model({"x": "y", "y": "m + n*y + c*x^2 + x*y + x^3"}, {"m": -1, "n": -0.5, "c": 1})
    folds = contin.continuation(
        line(system, {"x": -1.6}, "m", (-4, 4))["LP1"].locus(("m", "n")), ("m", "n"), {"m": (-4, 4), "n": (-4, 4)}
    )
    names = ("m", "n", "c")
    found = contin.continuation(folds["BT1"].locus(names), names, {"m": WIDE, "n": WIDE, "c": (-1, 3)})
    assert np.abs(found.columns["m"]).max() < 1e-10
    assert np.abs(found.columns["n"]).max() < 1e-10
    assert [p.type for p in found.points] == ["DBT"]
    assert abs(found["DBT1"].values["c"]) < 1e-9
    assert found["DBT1"].normal_form["a"] == 0.0
    assert found["DBT1"].normal_form["b"] == pytest.approx(1.0)


def bautin():
    """l1 ~ b - c^2 + d and l2 ~ c on the Hopf curve m = 0."""
    rate = "(b - c^2 + d)*(x^2 + y^2) + c*(x^2 + y^2)^2"
    equations = {"x": f"m*x - y + x*({rate})", "y": f"x + m*y + y*({rate})"}
    return model(equations, {"m": -1, "b": -1, "c": 1, "d": 0.5})


def test_a_curve_of_bautin_points():
    hopf = contin.continuation(
        line(bautin(), {"x": 0}, "m", (-1, 1))["HB1"].locus(("m", "b")), ("m", "b"), {"m": (-1, 1), "b": (-2, 4)}
    )
    names = ("m", "b", "c")
    found = contin.continuation(hopf["GH1"].locus(names), names, {"m": (-1, 1), "b": (-2, 6), "c": (-1, 2)})
    assert np.allclose(found.columns["b"], found.columns["c"] ** 2 - 0.5, atol=1e-8)
    assert [p.type for p in found.points] == ["DGH"]
    assert abs(found["DGH1"].values["c"]) < 1e-6
    assert found["DGH1"].normal_form["l2"] == 0.0


@pytest.mark.parametrize("type_", ["ZH", "HH"])
def test_curves_on_which_two_things_are_critical(type_):
    """A pair m +- 2i beside z' = n - z^2 + c (zero at n = -c), or beside a pair n + c +- i."""
    equations = {"x": "m*x - 2*y - x*(x^2 + y^2)", "y": "2*x + m*y - y*(x^2 + y^2)"}
    if type_ == "ZH":
        equations |= {"z": "n + c - z^2 + m*z", "w": "-w"}
    else:
        equations |= {"z": "(n + c)*z - w - z^3", "w": "z + (n + c)*w"}
    system = model(equations, {"m": -1, "n": 0.5, "c": 0.2})
    first = line(system, {"z": 0.4 if type_ == "ZH" else 0}, "m", (-1, 1))
    hopf = contin.continuation(first["HB1"].locus(("m", "n")), ("m", "n"), {"m": (-2, 2), "n": (-1, 1)})
    names = ("m", "n", "c")
    point = next(p for p in hopf.points if p.type == type_)
    found = contin.continuation(point.locus(names), names, {"m": (-2, 2), "n": (-1, 1), "c": (-0.9, 0.9)})
    assert np.abs(found.columns["m"]).max() < 1e-9
    assert np.allclose(found.columns["n"], -found.columns["c"], atol=1e-9)
    assert len(found) > 5


def test_generic_branch_points_in_three_parameters():
    """(x - s)(p - x - s) + r - s^2: branches in p cross at p = 2 s, x = s, r = s^2."""
    system = model({"x": "(x - s)*(p - x - s) + r - s^2"}, {"p": 0, "r": 0.25, "s": 0.5})
    crossing = line(system, {"x": 0.5}, "p", (-2, 3))["BP1"]
    names = ("p", "r", "s")
    found = contin.continuation(crossing.locus(names), names, {"p": (-4, 4), "r": (-4, 4), "s": (-1, 1)})
    s = found.columns["s"]
    assert np.allclose(found.columns["p"], 2 * s, atol=1e-9)
    assert np.allclose(found.columns["x"], s, atol=1e-9)
    assert np.allclose(found.columns["r"], s**2, atol=1e-9)
    assert found.locus == "BP"


def test_isola_centres_from_an_extremum_on_a_curve_of_folds():
    """F = p^2 + (x - s p)^2 - r + x^3: F_x = F_p = 0 at an isola centre."""
    system = model({"x": "p^2 + (x - s*p)^2 - r + x^3"}, {"p": 0, "r": 1, "s": 0.5})
    folds = contin.continuation(
        line(system, {"x": 1}, "p", (-3, 3))["LP1"].locus(("p", "r")), ("p", "r"), {"p": (-3, 3), "r": (-3, 10)},
        extrema=["r"],
    )  # fmt: skip
    names = ("p", "r", "s")
    point = min((p for p in folds.points if p.type == "EX"), key=lambda p: p.values["x"])
    found = contin.continuation(point.locus(names), names, {"p": (-3, 3), "r": (-10, 10), "s": (-2, 2)})
    p, r, s, x = (found.columns[name] for name in ("p", "r", "s", "x"))
    assert np.allclose(p**2 + (x - s * p) ** 2 - r + x**3, 0.0, atol=1e-9)
    assert np.allclose(2 * (x - s * p) + 3 * x**2, 0.0, atol=1e-8)
    assert np.allclose(2 * p - 2 * s * (x - s * p), 0.0, atol=1e-8)
    assert np.ptp(s) > 3.9


def test_folds_under_a_condition():
    """With c = -x^2 folds of the quartic have b = -2 x^3 and a = 2 x^4; the cusp at 0 is touched, not crossed."""
    first = line(quartic(), {"x": 2}, "a", (-40, 4))["LP1"]
    found = contin.continuation(
        first.locus(("a", "b")), ("a", "b"), {"a": WIDE, "b": WIDE}, conditions=["c = -x^2"], free=["c"]
    )
    x = found.columns["x"]
    assert np.allclose(found.columns["a"], 2 * x**4, atol=1e-8)
    assert np.allclose(found.columns["b"], -2 * x**3, atol=1e-8)
    assert np.allclose(found.columns["c"], -(x**2), atol=1e-8)
    assert found.free == ("c",)
    assert found.parameters == ("a", "b")


def test_cusps_and_bautin_points_are_labelled_under_conditions():
    first = line(quartic(), {"x": 2}, "a", (-40, 4))["LP1"]
    found = contin.continuation(
        first.locus(("a", "b")), ("a", "b"), {"a": WIDE, "b": WIDE}, conditions=["c = b/4 - 1"], free=["c"]
    )
    cusps = sorted(p.values["x"] for p in found.points)  # b = 8 x^3, c = -6 x^2
    exact = sorted(r.real for r in np.roots([2, 6, 0, -1]) if abs(r.imag) < 1e-12 and abs(8 * r**3) < 40)
    assert np.allclose(cusps, exact, atol=1e-9)
    assert {p.type for p in found.points} == {"CP"}
    hopf = line(bautin(), {"x": 0}, "m", (-1, 1))["HB1"]
    found = contin.continuation(
        hopf.locus(("m", "b")), ("m", "b"), {"m": (-1, 1), "b": (-4, 3)}, conditions=["c = b"], free=["c"]
    )
    assert [p.type for p in found.points] == ["GH", "GH"]  # b - b^2 + 1/2 = 0
    assert [p.values["b"] for p in found.points] == pytest.approx([0.5 * (1 - 3**0.5), 0.5 * (1 + 3**0.5)], abs=1e-8)
    assert found.columns["m"] == pytest.approx(0.0, abs=1e-10)


def test_period_doublings_of_a_map_under_a_condition():
    """x -> a x (1 - x) + b: a (1 - 2 x) = -1."""
    system = model({"x": "a*x*(1 - x) + b + c"}, {"a": 2.5, "b": 0, "c": 0}, kind="map")
    first = line(system, {"x": 0.6}, "a", (2, 3.9))["PD1"]
    found = contin.continuation(
        first.locus(("a", "b")), ("a", "b"), {"a": (1, 3.9), "b": (-1, 1)}, conditions=["c = b*x"], free=["c"]
    )
    a, b, c, x = (found.columns[name] for name in ("a", "b", "c", "x"))
    assert np.allclose(a * (1 - 2 * x), -1.0, atol=1e-9)
    assert np.allclose(a * x * (1 - x) + b + c - x, 0.0, atol=1e-9)
    assert np.allclose(c, b * x, atol=1e-9)


@pytest.mark.seldom
def test_successive_extrema():
    """x falls with a distance squared: largest at a = b/2, then b = c, then c = 1."""
    equations = {"x": "-x + 3 - (a - 0.5*b)^2 - 2*(b - c)^2 - (c - 1)^2 + 0.02*x^2"}
    system = model(equations, {"a": 0, "b": 1, "c": 0.5}, observables={"phi": "x^3"})
    one = line(system, {"x": 0}, "a", (-2, 2), extrema=["phi"])["EX1"]
    box = {"a": (-3, 3), "b": (-3, 3)}
    wide = {"max_step": 0.2}
    second = contin.continuation(one.locus(("a", "b")), ("a", "b"), box, extrema=["phi"], settings=wide)
    assert np.allclose(second.columns["a"], 0.5 * second.columns["b"], atol=1e-8)
    box |= {"c": (-3, 3)}
    names = ("c", "a", "b")
    third = contin.continuation(second["EX1"].locus(names), names, box, extrema=["phi"], settings=wide)
    assert np.allclose(third.columns["b"], third.columns["c"], atol=1e-7)
    best = third["EX1"]
    assert best.values["c"] == pytest.approx(1.0, abs=1e-7)
    assert best.normal_form["kind"] == "maximum"


def test_what_cannot_be_followed_is_said():
    one = line(quartic(), {"x": 2}, "a", (-40, 4), extrema=["x"])
    with pytest.raises(InputError, match="no curve in three parameters"):
        one["LP1"].locus(("a", "b", "c"))
    with pytest.raises(InputError, match="varies in this run already"):
        contin.continuation(
            one["LP1"].locus(("a", "b")), ("a", "b"), {"a": WIDE, "b": WIDE}, conditions=["c = 1"], free=["b"]
        )


def test_curves_of_algebraic_equations_know_no_stability():
    """Written as two equations in any order: folds and cusps, and nothing that eigenvalues would say."""
    equations = {"x": "y - x^2", "y": "a + b*x + c*y + y^2"}
    for order in (("x", "y"), ("y", "x")):
        first, second = (equations[name] for name in order)
        system = model({"x": first, "y": second}, {"a": -3, "b": -3, "c": -1}, kind="algebraic")
        folds = contin.continuation(
            line(system, {"x": 2, "y": 4}, "a", (-40, 4))["LP1"].locus(("a", "b")), ("a", "b"), {"a": WIDE, "b": WIDE}
        )
        assert [p.type for p in folds.points] == ["CP", "CP"]
        assert "unstable" not in folds.columns
        assert folds["CP1"].eigenvalues.size == 0
        names = ("a", "b", "c")
        cusps = contin.continuation(folds["CP1"].locus(names), names, {"a": WIDE, "b": WIDE, "c": (-3, 3)})
        assert [p.type for p in cusps.points] == ["SW"]
        assert np.allclose(cusps.columns["c"], -6 * cusps.columns["x"] ** 2, atol=1e-9)
        assert "stable" not in cusps.columns
