"""Two species that compete: a = b = 1 has a line of equilibria, and trace zero makes the system integrable.

Lotka and Volterra's x' = x(1 - x - a y), y' = 2 y(1 - y - b x). On the line x + y = 1 at a = b = 1 the reduced equation
vanishes; where a = 3 - 2 b the state of both has trace zero, and centres, l1 = 0 (Dulac's function 1/(xy) makes its
divergence zero there).
"""

import numpy as np
import pytest

import contin
from tests.problems.follow import model

COMPETITION = model(
    {"x": "x*(1 - x - a*y)", "y": "2*y*(1 - y - b*x)"}, {"x": 0.5, "y": 0.5}, {"a": 0.5, "b": 0.5}
)
BOX = {"a": (0.2, 2.0), "b": (0.2, 2.0)}


@pytest.mark.parametrize("name", ["a", "b"])
def test_no_sign_is_made_of_the_rounding_of_a_cubic_coefficient_that_vanishes(name):
    line = contin.continuation(contin.equilibrium(COMPETITION), name, (0.2, 1.8))
    curve = contin.continuation(line["BP1"].locus(), ["a", "b"], BOX)
    assert [p.type for p in curve.points] == ["DP"]
    form = curve["DP1"].normal_form
    assert abs(form["b30"]) <= form["errors"]["b30"] < 1e-10
    assert form["criticality"] == "degenerate"
    assert {end.reason for end in curve.ends} == {"bound"}  # an equation that vanishes to second order is no failure
    folds = contin.continuation(curve["DP1"].locus(), ["a", "b"], BOX)
    assert {end.reason for end in folds.ends} == {"degenerate"}
    assert np.ptp(folds.columns["a"]) < 1e-12


def test_a_curve_of_centres_is_followed_to_infinity_without_a_sign_of_rounding():
    start = contin.equilibrium(COMPETITION, {"x": 3.3, "y": -1.6}, parameters={"a": 1.35, "b": 0.8})
    hopf = contin.continuation(start, "a", (1.3, 1.5))["HB1"]
    curve = contin.continuation(hopf.locus(), ["a", "b"], BOX)
    assert [p.type for p in curve.points] == ["BT"]  # no GH
    assert len(curve.notes) <= 1  # 1,138 changes of sign before, each with 7 failures of Newton's method
    assert all("lost in their rounding errors" in note for note in curve.notes)
    assert curve.steps < 3000  # 20,000 where l1 had signs of rounding
    assert np.allclose(curve.columns["a"] + 2.0 * curve.columns["b"], 3.0, rtol=0.0, atol=1e-12)
    assert any("grows without bound" in end.text for end in curve.ends)  # x = 2/(2 b - 1)


@pytest.mark.long  # every day: its curves above, and the regions of tests/diagram/phase
def test_its_plane_has_the_regions_of_the_textbook_and_those_of_negative_densities():
    found = contin.phase(COMPETITION, ("a", "b"), {"a": (0.5, 1.5), "b": (0.5, 1.5)}, orbits=False)
    areas = sorted((region.stable, round(region.area, 4)) for region in found.regions)
    corner = 0.5 * 0.5 * 0.25  # beside a = 3 - 2 b, where the saddle of both species has become a stable state
    assert areas == [(1, 0.25 - corner), (1, 0.25), (1, 0.25), (2, corner), (2, 0.25)]
