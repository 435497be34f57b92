"""Folds that depend on no free parameter: there the curve of conditioned solutions turns at the same place."""

import contin


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
