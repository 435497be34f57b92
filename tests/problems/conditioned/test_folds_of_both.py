"""Folds that depend on no free parameter: there the curve of conditioned solutions turns at the same place."""

import pytest

import contin
from contin.errors import InputError


def test_of_cycles():
    """m = r^4 - r^2 turns at -1/4, whatever the angular velocity is that keeps the period at 5."""
    rate = "(m + x^2 + y^2 - (x^2 + y^2)^2)"
    model = contin.Model(
        name="radial", states={"x": 0.94, "y": 0}, parameters={"m": -0.1, "c": 0.3, "om": 1},
        equations={"x": f"x*{rate} - (om + c*(x^2 + y^2))*y", "y": f"y*{rate} + (om + c*(x^2 + y^2))*x"},
    )  # fmt: skip
    start = contin.periodic_orbit(model, {"x": 0.94, "y": 0})
    found = contin.continuation(start, "m", (-0.3, -0.08), conditions=["period = 5"], free=["om"])
    assert [p.type for p in found.points] == ["LPC"]
    assert not found.notes
    assert abs(found["LPC1"].values["m"] + 0.25) <= found["LPC1"].error
    # R' = -2 R0 d^2 beside R0 = 1/2, and d = -(w/c) xi since the phase runs as 1 - xi: b = 2 R0 w/c, w = 2 pi/5
    form = found["LPC1"].normal_form
    assert abs(form["b"] - 0.4 * 3.141592653589793 / 0.3) <= form["errors"]["b"]


def test_of_equilibria():
    """p = x^2, whatever q is; the top of a pitchfork's side branch beside its own fold is the branch point still."""
    more = {"conditions": ["y = 1 + 0.3*p"], "free": ["q"]}
    for equation, types in (("p - x^2", ["LP"]), ("x*(p + 0.1*q - x^2)", ["LP", "BP"])):
        model = contin.Model(
            name="e", states={"x": 1, "y": 1}, parameters={"p": 1, "q": 0}, equations={"x": equation, "y": "q - y + x"}
        )
        found = contin.continuation(contin.equilibrium(model, {"x": 1, "y": 1}), "p", (-1, 2), **more)
        assert [p.type for p in found.points] == types
        last = found.points[-1].values
        assert abs(last["p"] + (0.1 * last["q"] if types[-1] == "BP" else 0.0)) <= 1e-12


@pytest.mark.long
def test_the_top_of_a_side_branch_where_stability_only_touches_zero():
    """z = 0 and z^2 = mu - 3/2 on the circle r^2 = mu: the curve turns since the side branch does, in a BPC."""
    rate = "(mu - x^2 - y^2)"
    model = contin.Model(
        name="side", states={"x": 1.3, "y": 0, "z": 0.4}, parameters={"mu": 1.66, "om": 1},
        equations={"x": f"x*{rate} - (om + mu/3)*y", "y": f"y*{rate} + (om + mu/3)*x", "z": "(mu - 1.5)*z - z^3"},
    )  # fmt: skip
    start = contin.periodic_orbit(model, {"x": 1.3, "y": 0, "z": 0.4})
    found = contin.continuation(start, "mu", (1.3, 1.7), conditions=["period = 4"], free=["om"])
    assert [p.type for p in found.points] == ["BPC"]
    assert abs(found["BPC1"].values["mu"] - 1.5) <= max(found["BPC1"].error, 1e-13)


def test_a_fold_of_the_curve_alone_has_no_curve_of_folds():
    """p = x^2 - x/10 turns at x = .05; a curve of folds at fixed q, which begin at x = 0, was followed from there."""
    model = contin.Model(
        name="e", states={"x": 1}, parameters={"p": 1, "q": 0, "r": 0}, equations={"x": "p + q - x^2 + r*x"}
    )
    start = contin.equilibrium(model, {"x": 1})
    found = contin.continuation(start, "p", (-1, 2), conditions=["q = 0.1*x"], free=["q"])
    fold = next(p for p in found.points if p.normal_form.get("of") == "curve")
    assert fold.values["p"] == pytest.approx(-0.0025)
    with pytest.raises(InputError, match="a fold of the curve of solutions that meet the conditions"):
        fold.locus(("p", "r"))
