"""Curves and points of codimension two of the normal forms, in their own and in hidden coordinates."""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import (
    BAUTIN,
    BOGDANOV_TAKENS,
    CUSP,
    DOUBLE_HOPF,
    PITCHFORK,
    TRANSCRITICAL,
    assert_points,
    columns,
    zero_hopf,
)

SEEDS = [None, 1, 2]


def reasons(branch):
    return tuple(end.reason for end in branch.ends)


@pytest.mark.parametrize("seed", SEEDS)
def test_folds_of_the_cusp_lie_on_its_semicubical_parabola(seed):
    curve = CUSP.curve("LP1", seed)
    p, q = columns(curve, "p", "q")
    np.testing.assert_allclose(27 * p**2, 4 * q**3, atol=1e-9)
    assert_points(curve, [("CP", 0.0, 0.0)])
    assert reasons(curve) == ("bound", "bound")
    assert len(curve) < 80  # effort: measured 48


@pytest.mark.parametrize("seed", SEEDS)
def test_bogdanov_takens_form_has_a_parabola_of_folds_and_a_line_of_hopf_points(seed):
    line = BOGDANOV_TAKENS.line(seed)
    assert sorted(p.type for p in line.points) == ["HB", "LP"]
    folds = BOGDANOV_TAKENS.curve("LP1", seed)
    p, q = columns(folds, "p", "q")
    np.testing.assert_allclose(p, q**2 / 4, atol=1e-9)
    hopf = BOGDANOV_TAKENS.curve("HB1", seed)
    p, q, kappa, neutral = columns(hopf, "p", "q", "kappa", "neutral")
    np.testing.assert_allclose(p, 0.0, atol=1e-9)
    np.testing.assert_allclose(kappa, -q, atol=1e-8)  # the equilibrium w0 = 0 has eigenvalues l^2 = q
    assert np.array_equal(neutral[np.abs(q) > 1e-6], q[np.abs(q) > 1e-6] > 0.0)
    for curve in (folds, hopf):
        assert_points(curve, [("BT", 0.0, 0.0)])
        form = curve["BT1"].normal_form
        assert form["a"] * form["b"] < 0  # s = -1 in the form itself, an invariant of coordinates


def test_stop_at_bt_ends_the_curve_of_hopf_points_there():
    curve = BOGDANOV_TAKENS.curve("HB1", settings={"stop_at": ["BT"]})
    assert "bt" in reasons(curve)
    assert not np.any(curve.columns["neutral"])
    end = 0 if curve.ends[0].reason == "bt" else -1
    assert (curve.columns["p"][end], curve.columns["q"][end]) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert curve.points[end].type == "BT"


@pytest.mark.parametrize("seed", SEEDS)
def test_bautin_form_has_one_point_where_the_hopf_line_changes_criticality(seed):
    curve = BAUTIN.curve("HB1", seed)
    np.testing.assert_allclose(curve.columns["p"], 0.0, atol=1e-9)
    np.testing.assert_allclose(curve.columns["kappa"], 1.0, rtol=1e-8)
    assert_points(curve, [("GH", 0.0, 0.0)])
    assert curve["GH1"].normal_form["l2"] < 0


def test_second_lyapunov_coefficient_is_that_of_the_form_for_a_unit_eigenvector():
    # z' = z(p + i - |z|^4): with |q| = 1, w = (z + ...)/sqrt(2), so Re c2 = -4 and l2 = Re c2
    assert BAUTIN.curve("HB1")["GH1"].normal_form["l2"] == pytest.approx(-4.0, rel=1e-9)


@pytest.mark.parametrize(
    ("s", "theta", "seed"),
    [
        pytest.param(*case, seed, marks=() if seed in (None, 1 + k % 2) else pytest.mark.long)  # one change of states
        for k, case in enumerate([(1, 0.7), (1, -0.6), (-1, 0.8), (-1, -0.9)])
        for seed in SEEDS
    ],
)
def test_zero_hopf_form_in_all_four_cases(seed, s, theta):
    line = zero_hopf(s, theta)
    folds = line.curve("LP1", seed)
    np.testing.assert_allclose(folds.columns["p"], 0.0, atol=1e-9)
    for curve in (folds, *_hopf_curves(line, seed)):
        assert ("ZH", 0.0, 0.0) in [(t, round(a, 8) + 0.0, round(b, 8) + 0.0) for t, a, b in _points(curve)]
        point = next(p for p in curve.points if p.type == "ZH" and abs(p.values["q"]) < 1e-6)
        assert point.normal_form["s"] == s
        assert point.normal_form["theta"] == pytest.approx(theta, rel=1e-6)


def _points(curve):
    return [(p.type, p.values["p"], p.values["q"]) for p in curve.points]


def _hopf_curves(plane, seed):
    """Equilibria w0 = x, z = 0: p = -x^2, and q = -theta x - x^2 at Hopf points."""
    line = plane.line(seed)
    for point in (p for p in line.points if p.type == "HB"):
        curve = plane.curve(point.label, seed)
        p, q = columns(curve, "p", "q")
        theta = float(plane.field[1].split("(")[2].split(")")[0])
        np.testing.assert_allclose((q - p) ** 2, -p * theta**2, atol=1e-8)
        yield curve


@pytest.mark.parametrize("seed", SEEDS)
def test_hopf_lines_of_the_double_hopf_form_cross_at_its_point(seed):
    line = DOUBLE_HOPF.line(seed)
    curves = [DOUBLE_HOPF.curve(p.label, seed) for p in line.points]
    assert len(curves) == 2
    for curve in curves:
        p, q, kappa = columns(curve, "p", "q", "kappa")
        on = (p - 0.5 * q) if kappa[0] < 3.0 else (q + 0.25 * p)
        np.testing.assert_allclose(on, 0.0, atol=1e-9)
        assert_points(curve, [("HH", 0.0, 0.0)])
        form = curve["HH1"].normal_form
        frequencies = sorted([form["omega1"], form["omega2"]])
        assert frequencies == pytest.approx([1.0, 2.3], rel=1e-8)
        assert sorted([form["theta"], form["delta"]]) == pytest.approx([2.0, 3.0], rel=1e-7)  # p12/p22, p21/p11


@pytest.mark.parametrize("seed", SEEDS)
def test_transcritical_line_has_one_degenerate_point_and_the_folds_touch_it_there(seed):
    curve = TRANSCRITICAL.curve("BP1", seed)
    np.testing.assert_allclose(curve.columns["p"], 0.0, atol=1e-9)
    assert_points(curve, [("DP", 0.0, 0.0)])
    others = [s.problem.locus for s in curve["DP1"].locus(("p", "q"))]
    assert others == ["LP"]


def test_folds_that_end_on_branch_points_end_in_dp_not_in_a_cusp():
    from tests.loci.equilibria.planes import Plane

    # x (p + q x - x^2): folds off x = 0 where x = q/2, p = -q^2/4
    other = Plane(TRANSCRITICAL.field, (0.8, 0.64), {"p": 0.08, "q": 0.7})
    curve = other.curve("LP1")
    np.testing.assert_allclose(curve.columns["p"], -(curve.columns["q"] ** 2) / 4, atol=1e-9)
    assert_points(curve, [("DP", 0.0, 0.0)], atol=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_pitchfork_line_has_one_point_where_its_criticality_changes(seed):
    curve = PITCHFORK.curve("BP1", seed)
    np.testing.assert_allclose(curve.columns["p"], 0.0, atol=1e-9)
    assert_points(curve, [("DP", 0.0, 0.0)])


@pytest.mark.parametrize("place", [0.0, 0.3, 1.3])
def test_a_cusp_at_which_three_test_zeros_coincide_has_c_zero_to_its_error(place):
    """a + b y + y^5, y = x - place: Newton's method stalls at |y| = 1e-7, and c = 2 y^2 there was beyond its error."""
    y = f"(x - {place})"
    model = Model(
        "butterfly", states={"x": place + 1.0}, parameters={"a": 0.0, "b": -2.0}, equations={"x": f"a + b*{y} + {y}^5"}
    )
    box = {"a": (-5.0, 5.0), "b": (-5.0, 5.0)}
    line = contin.continuation(contin.equilibrium(model), "a", box["a"])
    (cusp,) = contin.continuation(line["LP1"].locus(("a", "b")), ("a", "b"), box).points
    assert cusp.type == "CP"
    assert abs(cusp.normal_form["c"]) <= cusp.normal_form["errors"]["c"]
