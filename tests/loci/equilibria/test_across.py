"""Curves of branch points along which the first parameter alone varies: it does not cross them."""

import numpy as np
import pytest

import contin

BOX = {"p": (-1, 1), "q": (-1, 1)}
PARAMETERS = {"p": -0.5, "q": -0.3}
SYSTEMS = {
    "one state": ({"x": "x*(q - x)*(2 + p)"}, "flow"),
    "two states": ({"x": "x*(q - x + y^2/3)", "y": "-(2 + p + x/2)*y + y^3"}, "flow"),
    "pitchfork, one state": ({"x": "x*(q - x^2)"}, "flow"),
    "skewed": ({"x": "(x - y)*(q - x + y) - y", "y": "-y*(2 + p)"}, "flow"),
    "map": ({"x": "x + x*(q - x + y^2/3)", "y": "-(1 + p + x/2)*y + y^3"}, "map"),
}


@pytest.mark.parametrize("names", [("p", "q"), ("q", "p")])
@pytest.mark.parametrize("name", SYSTEMS)
def test_branch_points_on_q_0_are_followed_whichever_parameter_is_the_first(name, names):
    """x = 0 (x = y = 0) is always a solution; its branch points are q = 0 for every p.

    With p the first they were not followed, and of one state a note said that nothing forces them.
    """
    equations, kind = SYSTEMS[name]
    model = contin.Model("forced", kind=kind, states=dict.fromkeys(equations, 0.0), parameters=PARAMETERS,
                         equations=equations)  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "q", BOX["q"])
    curve = contin.continuation(line["BP1"].locus(names), names, BOX)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert not curve.notes
    np.testing.assert_allclose(curve.columns["q"], 0.0, atol=1e-12)
    assert np.ptp(curve.columns["p"]) == pytest.approx(2.0)


@pytest.mark.parametrize("names", [("p", "q"), ("q", "p")])
def test_fold_flip_points_on_an_invariant_plane_lead_to_branch_points(names):
    """On x = 0 nothing unfolds the multiplier 1: there are no folds ("curve of LP", with notes of crossing ones)."""
    equations, _ = SYSTEMS["map"]
    model = contin.Model("flips", kind="map", states={"x": 0.0, "y": 0.0}, parameters=PARAMETERS, equations=equations)
    line = contin.continuation(contin.equilibrium(model), "p", BOX["p"])
    flips = contin.continuation(line["PD1"].locus(names), names, BOX)
    curves = [contin.continuation(seed, names, BOX) for seed in flips["LPPD1"].locus(names)]
    assert [curve.locus for curve in curves] == ["BP"]
    np.testing.assert_allclose(curves[0].columns["q"], 0.0, atol=1e-12)
    back = curves[0]["LPPD1"].locus(names)
    assert [seed.problem.locus for seed in back] == ["PD"]
