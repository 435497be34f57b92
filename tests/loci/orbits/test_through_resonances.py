"""Curves of folds and of tori of a stiff flow (Steinmetz and Larter 1991) that start at a GH point and meet at R1."""

from __future__ import annotations

import numpy as np
import pytest

import contin

NAMES, BOX = ("k7", "k8"), {"k7": (0.1, 8.0), "k8": (0.01, 5.0)}
MODEL = {
    "contin": 1, "name": "steinmetz-larter",
    "states": {"A": 1.8, "B": 25.6, "X": 0.0152, "Y": 0.178},
    "parameters": {
        "k1": 0.1631021, "k2": 1250, "k3": 0.046875, "k4": 20, "k5": 1.104, "k6": 0.001, "k7": 0.712, "k8": 0.5,
        "km7": 0.1175,
    },
    "equations": {
        "A": "-k1*A*B*X - k3*A*B*Y + k7 - km7*A",
        "B": "-k1*A*B*X - k3*A*B*Y + k8",
        "X": "k1*A*B*X - 2*k2*X^2 + 2*k3*A*B*Y - k4*X + k6",
        "Y": "-k3*A*B*Y + 2*k2*X^2 - k5*Y",
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def hopf():
    rest = contin.equilibrium(contin.load(MODEL))
    line = contin.continuation(rest, "k7", (0.7, 0.75))
    assert line["HB1"].values["k7"] == pytest.approx(0.712475373, abs=1e-9)
    return contin.continuation(line["HB1"].locus(NAMES), NAMES, BOX)


@pytest.fixture(scope="module")
def folds(hopf):
    return contin.continuation(hopf["GH1"].locus(NAMES), NAMES, BOX, settings={"stop_at": ("R1",)})


def test_multipliers_that_are_critical_at_the_point_are_not_unstable(folds):
    assert folds["R11"].values["unstable"] == 0


@pytest.mark.long
def test_folds_by_shooting_meet_tori_where_those_by_collocation_do(hopf, folds):
    settings = {"stop_at": ("R1",), "method": "shooting"}
    point, other = folds["R11"], contin.continuation(hopf["GH1"].locus(NAMES), NAMES, BOX, settings=settings)["R11"]
    assert other.values["unstable"] == 0
    for name in NAMES:
        assert abs(other.values[name] - point.values[name]) <= 2.0 * (other.error + point.error)


def test_folds_are_followed_from_every_generalised_hopf_point(hopf, folds):
    """To both signs of l2; from the first one they pass R1, where a third multiplier is 1."""
    assert folds.ends[1].reason == "r1"
    other = contin.continuation(hopf["GH2"].locus(NAMES), NAMES, BOX, settings={"stop_at": ("CPC",)})
    assert other.ends[1].reason == "cpc"
    assert hopf["GH1"].normal_form["l2"] * hopf["GH2"].normal_form["l2"] < 0.0


def test_tori_go_through_the_resonance_at_which_they_meet_folds(folds):
    """The curve of tori has cos(theta) = 1 once, at the folds' R1: it does not go on along the folds, where it is 1."""
    seed, point = folds["R11"].locus(NAMES), folds["R11"]
    torus = next(s for s in (seed if isinstance(seed, list | tuple) else [seed]) if s.problem.locus == "NS")
    tori = contin.continuation(torus, NAMES, BOX, settings={"steps": 12})
    cosines = np.asarray(tori.columns["cos.theta"])
    assert np.sum(np.diff(np.sign(cosines - 1.0)) != 0) <= 2  # from the start, where it is 1, to either side
    assert [p.type for p in tori.points] in ([], ["R1"])
    assert np.ptp(cosines) > 1e-3
    assert point.error < 1e-5
