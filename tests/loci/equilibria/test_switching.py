"""From a point of codimension two to the other curves that pass through it."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from tests.loci.equilibria.planes import (
    BAUTIN,
    BOGDANOV_TAKENS,
    BOX,
    CUSP,
    DOUBLE_HOPF,
    PITCHFORK,
    TRANSCRITICAL,
    Plane,
    assert_points,
    columns,
    curves_through,
    follow,
    zero_hopf,
)


def types(branches):
    return sorted(b.locus for b in branches)


def test_from_bt_on_either_curve_to_the_other():
    folds, hopf = BOGDANOV_TAKENS.curve("LP1", 3), BOGDANOV_TAKENS.curve("HB1", 3)
    (other,) = curves_through(folds["BT1"])
    assert other.locus == "HB"
    np.testing.assert_allclose(other.columns["p"], 0.0, atol=1e-9)
    (other,) = curves_through(hopf["BT1"])
    assert other.locus == "LP"
    p, q = columns(other, "p", "q")
    np.testing.assert_allclose(p, q**2 / 4, atol=1e-9)
    assert_points(other, [("BT", 0.0, 0.0)])  # on every curve that it lies on
    assert (other.parent.branch, other.parent.label) == ("branch", "BT1")


def test_from_zh_to_the_hopf_curve_and_back_to_the_folds():
    plane = zero_hopf(1, 0.7)
    folds = plane.curve("LP1")
    (hopf,) = curves_through(folds["ZH1"])
    assert hopf.locus == "HB"
    p, q = columns(hopf, "p", "q")
    np.testing.assert_allclose((q - p) ** 2, -0.49 * p, atol=1e-8)
    point = next(p for p in plane.curve(_hopf_label(plane)).points if p.type == "ZH" and abs(p.values["q"]) < 1e-6)
    (back,) = curves_through(point)
    assert back.locus == "LP"
    np.testing.assert_allclose(back.columns["p"], 0.0, atol=1e-9)


def _hopf_label(plane):
    return next(p.label for p in plane.line().points if p.type == "HB")


def test_from_hh_to_the_hopf_curve_of_the_other_pair():
    points = DOUBLE_HOPF.line().points
    assert len(points) == 2
    for point in points:
        curve = DOUBLE_HOPF.curve(point.label)
        (other,) = curves_through(curve["HH1"])
        assert other.locus == "HB"
        assert abs(other.columns["kappa"][0] - curve.columns["kappa"][0]) > 1.0
        frequencies = [set(np.round(c.columns["kappa"], 6)) for c in (curve, other)]
        assert sorted(frequencies, key=min) == [{1.0}, {5.29}]


def test_from_cp_its_own_curve_in_both_directions():
    (folds,) = curves_through(CUSP.curve("LP1")["CP1"])
    p, q = columns(folds, "p", "q")
    np.testing.assert_allclose(27 * p**2, 4 * q**3, atol=1e-9)
    assert p.min() < -0.3 < 0.3 < p.max()  # both branches of the parabola


def test_from_gh_to_the_folds_of_cycles_alone():
    assert [seed.problem.locus for seed in BAUTIN.curve("HB1")["GH1"].locus(tuple(BOX))] == ["LPC"]


def test_from_dp_to_the_folds_that_touch_the_branch_points():
    (folds,) = curves_through(TRANSCRITICAL.curve("BP1")["DP1"])
    assert folds.locus == "LP"
    np.testing.assert_allclose(folds.columns["p"], -(folds.columns["q"] ** 2) / 4, atol=1e-8)


def test_from_a_point_of_codimension_two_to_equilibria_in_one_parameter():
    # w0 (q + w0) = -p with p = 0: w0 = -q and w0 = 0 cross at BT, so q unfolds two branches and p one fold
    point = BOGDANOV_TAKENS.curve("LP1")["BT1"]
    branch = contin.continuation(point.switch("p"), "p", (-1, 1))
    np.testing.assert_allclose(branch.columns["p"], -(branch.columns["x0"] ** 2), atol=1e-9)


@pytest.mark.parametrize(
    ("names", "message"),
    [(("p", "p"), "two parameters"), (("p", "r"), "no parameter 'r': the model has p, q"), (("p",), "two parameters")],
)
def test_a_wrong_pair_of_parameters_says_what_to_write(names, message):
    with pytest.raises(InputError, match=message):
        CUSP.line()["LP1"].locus(names)


def test_a_user_value_has_no_curve():
    line = CUSP.line(values={"p": [0.5]})
    uz = next(p for p in line.points if p.type == "UZ")
    with pytest.raises(InputError, match="UZ has no curve in two parameters"):
        uz.locus(tuple(BOX))


def test_folds_end_where_they_meet_pitchforks_and_start_there_once():
    # x (p + q x^2 - x^4): folds off x = 0 where x^2 = q/2, p = -q^2/4 for q > 0; x -> -x maps them onto themselves
    (folds,) = curves_through(PITCHFORK.curve("BP1")["DP1"])
    p, q = columns(folds, "p", "q")
    np.testing.assert_allclose(p, -(q**2) / 4, atol=1e-7)
    assert q.min() > -1e-9
    assert [end.reason for end in folds.ends] == ["start", "bound"]
    back = follow(Plane(PITCHFORK.field, (0.8, 0.0), {"p": 0.64 * (0.64 - 0.7), "q": 0.7}).line()["LP1"])
    np.testing.assert_allclose(back.columns["p"], -(back.columns["q"] ** 2) / 4, atol=1e-7)
    assert_points(back, [("DP", 0.0, 0.0)])
    assert sorted(end.reason for end in back.ends) == ["bound", "joined"]
    assert back.notes == ()


@pytest.mark.parametrize("seed", [None, 3])
def test_a_fold_curve_passes_a_second_zero_eigenvalue_with_an_eigenvector_of_its_own(seed):
    # folds p = 0 at w = 0 for every q; at q = 0 a pitchfork of the symmetry w1 -> -w1 passes: two zeros, but
    # there is neither a cusp nor a Bogdanov-Takens point
    plane = Plane(("p - w0^2", "(q + w0/2)*w1 - w1^3", "-w2 + w0/3"), (0.7, 0.0, 0.7 / 3), {"p": 0.49, "q": -0.6})
    (fold,) = (s for s in plane.line(seed).points if s.type == "LP")
    curve = follow(fold, ("p", "q"), BOX)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert curve.points == ()
    assert all("without a label" in note for note in curve.notes)  # no type has two zeros with two eigenvectors
    np.testing.assert_allclose(curve.columns["p"], 0.0, atol=1e-10)
    np.testing.assert_allclose([curve.columns["q"].min(), curve.columns["q"].max()], [-1.0, 1.0], atol=1e-9)
    assert set(np.abs(np.diff(curve.columns["unstable"]))) == {0, 1}
    assert len(curve.columns["q"]) < 120
