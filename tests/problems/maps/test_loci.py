"""Curves of folds, period doublings and Neimark-Sacker points of the Henon map in both parameters."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model

BOX = {"al": (-3, 5), "be": (-2, 3)}
NAMES = ("al", "be")
CYCLE = (1.37, 0.215, -0.0732)  # of the adaptive controller, near b = .28, k = 1
GPD = (0.863269470303660474, 0.251863865709134076)


@pytest.fixture(scope="module")
def line():
    """x -> y, y -> al - be x - y^2: multipliers with product be and sum -2 y (Kuznetsov, Elements, 3rd ed., ch. 9)."""
    model = Model(
        "henon", kind="map", states={"x": -1.3, "y": -1.3}, parameters={"al": -0.5, "be": 0.5},
        equations={"x": "y", "y": "al - be*x - y^2"},
    )  # fmt: skip
    return contin.continuation(contin.equilibrium(model), "al", (-2, 4))


def follow(point):
    return contin.continuation(point.locus(NAMES), NAMES, BOX)


def places(branch):
    return sorted((p.type, round(p.values["al"], 9), round(p.values["be"], 9)) for p in branch.points)


def test_folds_and_period_doublings_lie_on_parabolas_and_meet_where_both_multipliers_are_critical(line):
    folds, doublings = follow(line["LP1"]), follow(line["PD1"])
    al, be = folds.columns["al"], folds.columns["be"]
    np.testing.assert_allclose(al, -((1 + be) ** 2) / 4, atol=1e-10)
    al, be = doublings.columns["al"], doublings.columns["be"]
    np.testing.assert_allclose(al, 3 * (1 + be) ** 2 / 4, atol=1e-10)
    assert places(folds) == [("LPPD", 0, -1), ("R1", -1, 1)]
    form = folds["LPPD1"].normal_form  # of the generalised Henon map with R = 0
    assert (form["a"], form["b"]) == pytest.approx((1 / 2, 1 / 4), abs=1e-8)
    assert places(doublings) == [("LPPD", 0, -1), ("R2", 3, 1)]  # no GPD: the cubic coefficient has only poles


def test_the_strong_resonances_lie_on_the_line_of_unit_area(line):
    """be = 1, y = -cos theta, al = y^2 + 2 y: R2, R3, R4, R1 at 3, 5/4, 0, -1."""
    doublings = follow(line["PD1"])
    tori = follow(doublings["R21"])
    np.testing.assert_allclose(tori.columns["be"], 1, atol=1e-10)
    found = {p.type: p.values["al"] for p in tori.points}
    assert found == pytest.approx({"R1": -1, "R2": 3, "R3": 1.25, "R4": 0}, abs=1e-9)


def test_folds_of_doubled_cycles_end_where_they_meet_the_fixed_point():
    """x' = -(1 + p) x + q x^3 + x^5 has two-cycles +-x with p = q x^2 + x^4, whose folds p = -q^2/4 end at GPD.

    Beyond it the same cycles follow from their other point, with every label once more.
    """
    model = Model(
        "flip", kind="map", states={"x": 1.0}, parameters={"p": -0.3, "q": -2.0},
        equations={"x": "-(1 + p)*x + q*x^3 + x^5"},
    )  # fmt: skip
    cycles = contin.continuation(contin.equilibrium(model, {"x": 1.3}, period=2), "p", (-1.5, 1.0))
    folds = contin.continuation(cycles["LP1"].locus(), ("p", "q"), {"p": (-3, 1), "q": (-3, 3)})
    p, q = folds.columns["p"], folds.columns["q"]
    np.testing.assert_allclose(p, -(q**2) / 4, atol=1e-10)
    assert {end.reason for end in folds.ends} == {"bound", "joined"}
    row = -1 if folds.ends[1].reason == "joined" else 0
    assert abs(q[row]) < 1e-2
    assert len(np.unique(np.sign(folds.columns["x"]))) == 1
    assert folds.points == ()


def test_folds_of_doubled_cycles_come_to_generalised_doublings_where_their_equations_become_singular():
    """A quadratic map of three states: both ends of the curve are points GPD of the curve of doublings."""
    model = Model(
        "quadratic", kind="map", states={"x0": 0.0, "x1": 0.0, "x2": 0.0}, parameters={"p": 0.0, "q": 0.2}, equations={
            "x0": "-0.403*p + 0.314*q - 0.735*x0 + 0.18*x1 + 0.411*x2 - 0.375*x0*x0 - 0.534*x0*x1 - 0.27*x0*x2 +"
            " 0.189*x1*x1 + 0.075*x1*x2 - 0.42*x2*x2",
            "x1": "-0.135*p + 0.169*q - 0.139*x0 + 0.24*x1 + 0.841*x2 + 0.22*x0*x0 - 0.13*x0*x1 - 0.375*x0*x2 -"
            " 0.185*x1*x1 + 0.013*x1*x2 + 0.469*x2*x2",
            "x2": "0.551*p - 0.182*q + 0.764*x0 - 0.052*x1 + 0.349*x2 - 0.471*x0*x0 - 0.475*x0*x1 - 0.358*x0*x2 +"
            " 0.461*x1*x1 + 0.216*x1*x2 + 0.419*x2*x2",
        },
    )  # fmt: skip
    box = {"p": (-3, 3), "q": (-2, 2)}
    line = contin.continuation(contin.equilibrium(model), "p", (-3, 3))
    cycles = contin.continuation(line["PD2"].switch(), "p", (-3, 3), settings={"stop_at": ["LP"]})
    folds = contin.continuation(cycles["LP1"].locus(), ("p", "q"), box)
    assert [end.reason for end in folds.ends] == ["joined", "joined"]
    assert all("generalised period doubling" in end.text for end in folds.ends)
    doublings = contin.continuation(line["PD1"].locus(), ("p", "q"), box)
    places = [(point.values["p"], point.values["q"]) for point in doublings.points if point.type == "GPD"]
    for row in (0, -1):
        here = folds.columns["p"][row], folds.columns["q"][row]
        assert min(np.hypot(*np.subtract(here, place)) for place in places) < 1e-4


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_generalised_doublings_of_cycles_are_found_in_any_unit_of_the_states(unit):
    """An adaptive controller (Frouzakis, Adomaitis, Kevrekidis 1991): c, and its rounding errors, go as 1/unit^2.

    The place is by Newton's method in 40 digits on the cycle, det(A + 1) = 0 and c = 0 (mpmath).
    """
    model = Model(
        "adaptive", kind="map", states=dict(zip("XYZ", (v * unit for v in CYCLE), strict=True)),
        parameters={"b": 0.28, "k": 1.0}, definitions={"x": f"X/{unit!r}", "y": f"Y/{unit!r}", "z": f"Z/{unit!r}"},
        equations={
            "X": f"{unit!r}*y", "Y": f"{unit!r}*(b*x + k + y*z)",
            "Z": f"{unit!r}*(z - k*y/(0.1 + y^2)*(b*x + k + y*z - 1))",
        },
    )  # fmt: skip
    cycles = contin.continuation(contin.equilibrium(model, period=2), "b", (0.26, 0.32))
    doublings = contin.continuation(cycles["PD1"].locus(), ("b", "k"), {"b": (0.2, 1.5), "k": (0.1, 1.5)})
    assert [point.type for point in doublings.points] == ["GPD"]
    assert doublings["GPD1"].values["b"] == pytest.approx(GPD[0], abs=1e-9)
    assert doublings["GPD1"].values["k"] == pytest.approx(GPD[1], abs=1e-9)


def test_tori_of_doubled_cycles_end_at_the_resonance_of_the_fixed_point():
    """x' = y, y' = z, z' = M + B x + .7 y - z^2: -1 is double at M = .014375, B = .85, where no label repeats."""
    model = Model(
        "delayed", kind="map", states={"x": 0.0, "y": 0.0, "z": 0.0}, parameters={"M": 0.0, "B": 0.7},
        equations={"x": "y", "y": "z", "z": "M + B*x + 0.7*y - z^2"},
    )  # fmt: skip
    torus = contin.diagram(model, "M", (-0.1, 0.1))["start/PD1"]["NS1"]
    curve = contin.continuation(torus.locus(), ("M", "B"), {"M": (-2, 1.1), "B": (-1.5, 1.5)})
    assert [end.reason for end in curve.ends] == ["joined", "bound"]
    np.testing.assert_allclose(curve.z[0, [-1, -2]], [0.014375, 0.85], atol=2e-2)
    assert sorted(point.type for point in curve.points) == ["R2", "R3", "R4"]
    assert curve.notes == ()
