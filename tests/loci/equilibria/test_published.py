"""Published systems: their points of codimension two, and curves with closed forms."""

import numpy as np
import pytest

import contin
from tests.loci.equilibria.planes import follow


def line(name, parameter, bounds, start=None, **parameters):
    return contin.continuation(contin.equilibrium(contin.load(name), start, parameters), parameter, bounds)


def places(branch, type_):
    return sorted(tuple(p.values[n] for n in branch.parameters) for p in branch.points if p.type == type_)


def test_pitchforks_of_the_averaged_pair_lie_on_its_published_curve():
    # Kato and Kori: mu_c = -15 pi beta/8 + 27 a^2/(64 b) + 9 a/(64 b) sqrt(9 a^2 - 48 pi b beta), a = 4, b = 1
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    start = contin.equilibrium(slow, "in-phase", {"mu": 8, "beta": 0.8})
    branch = contin.continuation(start, "mu", (0.05, 8))
    fork = next(p for p in branch.points if p.type == "BP")
    curve = follow(fork, ("mu", "beta"), {"mu": (0.05, 10), "beta": (0.05, 1)})
    mu, beta = curve.columns["mu"], curve.columns["beta"]
    root = np.sqrt(np.maximum(144 - 48 * np.pi * beta, 0.0))
    away = beta < 0.9549  # the root is ill-conditioned at the tip
    np.testing.assert_allclose((mu + 15 * np.pi * beta / 8 - 6.75 - 0.5625 * root)[away], 0.0, atol=1e-8)
    assert "unfolding" not in curve.columns
    # it ends on the line of folds at beta = 3 a^2/(16 pi b), mu = 9 a^2/(128 b), where three eigenvalues vanish
    (tip,) = curve.points
    assert (tip.type, tip.values["mu"], tip.values["beta"]) == (
        "TZ",
        pytest.approx(1.125, abs=1e-6),
        pytest.approx(3 / np.pi),
    )
    assert sorted(end.reason for end in curve.ends) == ["bound", "joined"]


@pytest.mark.parametrize("start", ["in-phase", "anti-phase"])
def test_the_degenerate_line_of_the_averaged_pair_has_one_note_and_no_string_of_zh(start):
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    branch = contin.continuation(contin.equilibrium(slow, start, {"mu": 3, "beta": 0.8}), "beta", (0.05, 1))
    fold = next(p for p in branch.points if p.type == "LP")
    assert fold.also == ("ZH",)
    curve = follow(fold, ("mu", "beta"), {"mu": (0.05, 10), "beta": (0.05, 1)})
    np.testing.assert_allclose(curve.columns["beta"], 3 / np.pi, rtol=1e-9)
    assert [p.type for p in curve.points] == (["TZ"] if start == "in-phase" else [])
    (note,) = curve.notes
    assert "two more eigenvalues are imaginary all along" in note


def test_folds_of_the_unequal_states_of_the_pair_end_on_pitchforks_of_the_anti_phase_ones():
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    branch = contin.continuation(contin.equilibrium(slow, "in-phase", {"mu": 8, "beta": 0.8}), "mu", (0.05, 8))
    fork = contin.continuation(branch["BP1"].switch("mu"), "mu", (0.05, 8))
    folds = follow(fork["LP1"], ("mu", "beta"), {"mu": (0.05, 10), "beta": (0.05, 1)})
    assert sorted(p.type for p in folds.points) == ["BT", "BT", "CP", "DP", "ZH"]
    assert folds.notes == ()
    end = folds["DP1"]
    assert (end.values["S1"], end.values["S3"]) == pytest.approx((0.0, 0.0), abs=1e-9)  # equal amplitudes
    (hopf,) = folds["ZH1"].locus(("mu", "beta"))
    assert hopf.problem.locus == "HB"


def test_hopf_curve_of_the_pairs_unequal_states_does_not_turn_back_where_its_border_is_renewed():
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    branch = contin.continuation(contin.equilibrium(slow, "in-phase", {"mu": 8, "beta": 0.886}), "mu", (0.05, 8))
    fork = contin.continuation(branch["BP1"].switch("mu"), "mu", (0.05, 8))
    curve = follow(fork["HB2"], ("mu", "beta"), {"mu": (0.05, 8), "beta": (0.05, 1)}, settings={"max_step": 0.03})
    assert sorted(p.type for p in curve.points) == ["BT", "BT", "GH", "GH", "GH", "ZH", "ZH"]
    s1 = curve.columns["S1"]
    assert abs(s1[0] - s1[-1]) > 1.0  # two different ends


def test_morris_lecar_has_a_closed_curve_of_hopf_points_through_four_bt():
    branch = line("classics/morris-lecar", "I", (-50, 300), v3=2.0)
    curve = follow(branch["HB1"], ("I", "v3"), {"I": (-400, 800), "v3": (-150, 220)})
    assert [end.reason for end in curve.ends] == ["closed", "closed"]
    assert np.sum(np.diff(curve.columns["neutral"].astype(int)) != 0) == 4
    assert len(places(curve, "BT")) == 4
    for point in curve.points:
        assert point.values["kappa"] == pytest.approx(0.0, abs=1e-10)


def test_cusp_between_two_zero_hopf_points_a_ten_thousandth_away():
    # Kuznetsov, Meijer, Govaerts and Sautois (2008), extended Lorenz-84
    branch = line("classics/lorenz-84", "F", (1, 3.2), F=3.0, T=0.04)
    folds = next(p for p in branch.points if p.type == "LP")
    curve = follow(folds, ("F", "T"), {"F": (1, 4), "T": (-0.5, 0.5)})
    assert places(curve, "CP") == [pytest.approx((1.278283309881, 0.0), abs=1e-11)]
    below, above = sorted(places(curve, "ZH"), key=lambda place: place[1])
    assert above == pytest.approx((1.283419296138, 1.265408341205e-4), abs=1e-11)
    assert below == pytest.approx((above[0], -above[1]), abs=1e-12)  # T -> -T is a symmetry with the states' signs
    assert len(places(curve, "BT")) == 2


def test_laser_has_no_degenerate_pitchforks():
    # Maxwell-Bloch: pitchforks r = 1 for every k; on them b30 never vanishes
    laser = contin.Model(
        "laser", states={"E": 0.0, "P": 0.0, "D": 0.5}, parameters={"r": 0.5, "k": 2.0},
        equations={"E": "-k*(E - P)", "P": "-(P - E*D)", "D": "0.5*(r - D - E*P)"},
        symmetries={"flip": {"E": "-E", "P": "-P"}},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(laser), "r", (0.2, 20))
    curve = follow(branch["BP1"], ("r", "k"), {"r": (0.2, 20), "k": (0.2, 8)})
    np.testing.assert_allclose(curve.columns["r"], 1.0, atol=1e-10)
    assert curve.points == ()
    assert curve.notes == ()


def test_z2_symmetric_bt_on_a_curve_of_pitchforks_through_which_they_stay_regular():
    # x' = al (y - c x - x^3), y' = x - y + z, z' = -be y: at 0, det = -al be c and, at c = 0, trace terms vanish with
    # al = be: l^3 + l^2 + (be - al) l
    chua = contin.Model(
        "chua", states={"x": 0.0, "y": 0.0, "z": 0.0}, parameters={"c": -0.2, "al": 5.0, "be": 14.0},
        equations={"x": "al*(y - c*x - x^3)", "y": "x - y + z", "z": "-be*y"},
        symmetries={"flip": {"x": "-x", "y": "-y", "z": "-z"}},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(chua), "c", (-0.5, 0.5))
    curve = follow(branch["BP1"], ("c", "al"), {"c": (-0.5, 0.5), "al": (1, 15)})
    (point,) = curve.points
    assert (point.type, point.values["al"]) == ("BT", pytest.approx(14.0, abs=1e-10))
    assert point.normal_form["kind"] == "Z2-symmetric"
    assert curve.notes == ()


@pytest.mark.parametrize("death", [0.1, 0.3])
def test_doublings_on_an_invariant_line_meet_the_multiplier_across_it(death):
    """Maynard Smith's predators and prey (AUTO's dd2): on u2 = 0, doublings at p1 = 3, invaded at p2 = 3 p3/2."""
    model = contin.Model(
        "predators", kind="map", states={"u1": 2 / 3, "u2": {"value": 0, "scale": 1}},
        parameters={"p1": 3.1, "p2": death, "p3": death},
        equations={"u1": "p1*u1*(1 - u1) - p2*u1*u2", "u2": "(1 - p3)*u2 + p2*u1*u2"},
    )  # fmt: skip
    states = contin.continuation(contin.equilibrium(model), "p1", (2.5, 3.5))
    curve = follow(states["PD1"], ("p1", "p2"), {"p1": (2.5, 3.5), "p2": (0, 1)})
    (met,) = curve.points
    assert met.type == "LPPD"
    assert abs(met.values["p2"] - 1.5 * death) <= met.error < 1e-8
    assert met.values["p1"] == pytest.approx(3.0, abs=1e-12)
    assert curve.unexplained == 0
