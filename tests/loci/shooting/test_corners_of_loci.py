"""Curves of folds whose orbits come to touch a switching surface, against quadrature of the radius."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from contin import api
from contin.loci.shooting.shot_locus import ShotLocusProblem
from tests.problems.shooting.bent import BENT, JUMPING, TOUCHED, bent, fold_at, gain

PAIR = ("b1", "b2")
BOX = {"b1": (-0.6, 0.3), "b2": (-0.9, 1.5)}


def born_at_bautin_point(model, box=BOX):
    line = api.continuation(api.equilibrium(model), "b1", (-0.6, 0.3))
    hopf = api.continuation(line["HB1"].locus(PAIR), PAIR, box)
    return api.continuation(hopf["GH1"].locus(PAIR), PAIR, box)


def follows_both_laws(folds):
    b1, b2, y = (folds.columns[name] for name in ("b1", "b2", "y.max"))
    inside = b2 < TOUCHED
    np.testing.assert_allclose(b1[inside], -(b2[inside] ** 2) / 4.0, atol=1e-9)
    outside = np.flatnonzero(b2 > TOUCHED + 1e-3)
    for row in outside[:: max(1, len(outside) // 3)]:
        assert gain(b1[row], b2[row], y[row]) == pytest.approx(0.0, abs=1e-8)
    assert float(np.max(b1[outside] + b2[outside] ** 2 / 4.0)) > 0.08  # far from the smooth law


def test_folds_born_inside_leave_the_smooth_law_where_their_orbits_touch_the_line():
    folds = born_at_bautin_point(BENT)
    assert isinstance(folds.problem, ShotLocusProblem)
    assert folds.parent.label == "GH1"
    assert (folds.columns["b1"][0], folds.columns["b2"][0]) == pytest.approx((0.0, 0.0), abs=1e-9)  # begins at it
    assert [end.reason for end in folds.ends] == ["start", "bound"]
    assert folds.columns["b2"][-1] == pytest.approx(1.5)
    follows_both_laws(folds)
    assert folds.points == ()  # the map's second derivative is negative on both sides of the touching orbit: no cusp
    assert folds.steps <= 60  # measured 37


@pytest.mark.seldom
def test_where_the_law_beyond_the_line_pushes_outwards_the_folds_have_the_cusp_of_the_return_map():
    """The map's second derivative jumps to +infinity at the touching orbit and is zero where b2(r) is smallest."""
    strength = -1.5
    folds = born_at_bautin_point(bent(strength))
    assert [p.label for p in folds.points] == ["CPC1"]
    cusp = folds["CPC1"]
    guess = [cusp.values["b1"], cusp.values["b2"]]
    least = minimize_scalar(lambda r: fold_at(r, guess, strength)[1], bounds=(0.52, 0.54), options={"xatol": 1e-7})
    np.testing.assert_allclose(guess, fold_at(least.x, guess, strength), atol=1e-9)
    turn = int(np.argmax(folds.columns["b2"][: cusp.index]))  # the curve comes back at the touching orbit
    assert folds.columns["x.max"][turn] == pytest.approx(0.5, abs=1e-4)


@pytest.mark.seldom
def test_folds_that_cross_the_line_come_back_to_the_smooth_law():
    orbit = api.periodic_orbit(BENT, {"x": 1.2, "y": 0.0}, {"b1": 0.1, "b2": 1.4})
    folds = api.continuation(api.continuation(orbit, "b1", (-0.6, 0.3))["LPC1"].locus(PAIR), PAIR, BOX)
    assert {end.reason for end in folds.ends} == {"bound", "hopf"}
    follows_both_laws(folds)


def test_where_solutions_slide_beyond_the_touching_orbit_the_curve_ends_and_says_so():
    """On x = c, y = 0- the flow inside leads out, that outside, slower by 3 r^5 cos(theta), leads in."""
    folds = born_at_bautin_point(JUMPING)
    np.testing.assert_allclose(folds.columns["b1"], -(folds.columns["b2"] ** 2) / 4.0, atol=1e-9)
    assert folds.columns["b2"][-1] == pytest.approx(TOUCHED, abs=1e-6)
    assert folds.ends[1].reason == "corrector"
    assert "on x - 0.5 = 0 both formulas lead back" in folds.ends[1].text


def test_two_orbits_of_one_period_are_both_marked():
    """The branch passes b1 = -0.2 before its fold and after it; the period is 2 pi on both sides."""
    line = api.continuation(api.equilibrium(BENT, None, {"b2": 1.4}), "b1", (-0.6, 0.3))
    family = api.continuation(line["HB1"].switch(), "b1", (-0.6, 0.3), values={"b1": [-0.2]})
    marked = [p for p in family.points if p.type == "UZ"]
    assert [p.values["unstable"] for p in marked] == [1, 0]


def test_a_walk_shoots_where_a_continuation_does():
    line = api.continuation(api.equilibrium(BENT, None, {"b2": -0.5}), "b1", (-0.6, 0.3))
    last = list(api.walk(line["HB1"].switch(), "b1", (-0.6, 0.3)))[-1]
    family = api.continuation(line["HB1"].switch(), "b1", (-0.6, 0.3))
    assert last["x.max"] == pytest.approx(family.columns["x.max"][-1], abs=1e-9)
    assert last["x.max"] > 0.5
