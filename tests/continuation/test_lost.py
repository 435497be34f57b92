"""Branches that go to infinity, or on at one parameter value, end there and say so; every point is one row."""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.continuation.test_range_and_starts import FOLD
from tests.problems.cases import oscillator
from tests.problems.follow import follow, labels, reasons


def test_a_pole_of_the_branch_is_an_end_and_no_fold():
    """x = 1/p: the branch p -> 0 has no fold; one at 1e15 would be rounding."""
    branch = follow({"x": "p*x - 1"}, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.0))
    assert labels(branch) == []
    assert reasons(branch) == ("bound", "bound")
    assert "grows without bound" in branch.ends[0].text
    assert branch.columns["x"] == pytest.approx(1.0 / branch.columns["p"], rel=1e-12)
    assert len(branch) < 1000


def test_competing_species_at_their_pole():
    """Coexistence x = 1/(2 - b), y = (1 - b) x of two competitors: both grow without bound as b -> 2."""
    equations = {"x": "x*(1 - x - 0.5*y)", "y": "y*(1 - y - b*x)"}
    branch = follow(equations, {"x": 2.0 / 3.0, "y": 2.0 / 3.0}, {"b": 0.5}, (0.0, 3.0))
    assert [t for t, _ in labels(branch)] == ["BP"]  # at b = 1, where y = 0
    assert "grows without bound" in branch.ends[1].text
    assert branch.ends[1].data["value"] == pytest.approx(2.0, abs=1e-8)


def test_a_curve_in_two_parameters_that_goes_to_infinity_ends_there():
    """x' = p - (q x - 1)^2: folds x = 1/q at p = 0."""
    model = Model(
        "far", states={"x": 1.0}, parameters={"p": 0.5, "q": 1.0}, equations={"x": "p - (q*x - 1)^2"}
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"x": 1.5}), "p", (-1.0, 1.0))
    folds = contin.continuation(line["LP1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-1, 2)})
    assert sorted(end.reason for end in folds.ends) == ["bound", "bound"]
    assert sum("x grows without bound" in end.text for end in folds.ends) == 1
    assert folds.columns["q"].min() == pytest.approx(0.0, abs=1e-9)
    assert len(folds) < 2000


def test_a_curve_that_comes_ever_nearer_to_a_corner_of_its_box_ends_there():
    """p exp(x/(1 + q x)) = x: the upper fold has x near 1/q^2 and p near exp(-1/q)/q^2, which never vanishes."""
    model = Model(
        "ignition", states={"x": 0.0}, parameters={"p": 0.0, "q": 0.2}, equations={"x": "p*exp(x/(1 + q*x)) - x"}
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (0.0, 2.0))
    folds = contin.continuation(line["LP1"].locus(("p", "q")), ("p", "q"), {"p": (0, 2), "q": (0, 0.4)})
    assert sum("the curve approaches p = 0 ever more closely" in end.text for end in folds.ends) == 1
    assert 0.0 < folds.columns["p"].min() < 1e-9
    assert [point.type for point in folds.points] == ["CP"]
    assert folds["CP1"].values["q"] == pytest.approx(0.25, abs=1e-9)
    assert len(folds) < 250


def test_a_curve_that_runs_along_a_bound_is_followed_to_its_end():
    """Folds of x' = p - exp(-q) - x^2 are p = exp(-q), which is nearer to 0 in every row up to q = 60."""
    model = Model("far", states={"x": 1.0}, parameters={"p": 2.0, "q": 0.0}, equations={"x": "p - exp(-q) - x^2"})
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 2.0))
    folds = contin.continuation(line["LP1"].locus(("p", "q")), ("p", "q"), {"p": (0, 2), "q": (0, 60)})
    assert folds.columns["q"].max() == pytest.approx(60.0)


def test_growth_by_itself_is_no_end():
    """A transcritical branch that starts at 1e-9 of its later size, and a parabola: nothing converges."""
    rising = follow({"x": "x*(p - x)"}, {"x": 1e-9}, {"p": 1e-9}, (-1.0, 1.0))
    assert rising.columns["p"].max() == 1.0
    parabola = follow({"x": "p - x^2"}, {"x": 1e-6}, {"p": 1e-12}, (-1.0, 1.0))
    assert parabola.columns["x"].max() == pytest.approx(1.0)


def test_a_family_at_one_parameter_value_ends():
    branch = follow({"x": "p"}, {"x": 0.0}, {"p": 0.0}, (-1.0, 1.0))
    assert "the parameter has not moved" in branch.ends[0].text
    assert len(branch) < 1400


def test_a_flat_stretch_is_crossed():
    """p = tanh(40 x) + tanh(40 (x - 2)) is 0 to 1e-9 over most of [0.3, 1.7]."""
    branch = follow({"x": "p - tanh(40*x) - tanh(40*(x - 2))"}, {"x": -0.01}, {"p": -1.38}, (-1.9, 1.9))
    assert branch.columns["p"].max() == 1.9


@pytest.mark.parametrize("equations", [{"x": "p*x - x^3"}, oscillator("x", "y", "p")])
def test_a_range_that_ends_on_a_special_point_has_one_row_there(equations):
    branch = follow(equations, dict.fromkeys(equations, 0.0), {"p": 1.0}, (0.0, 1.0))
    assert len(branch.points) == 1
    assert branch.points[0].index == 0
    assert np.all(np.diff(branch.columns["p"]) > 0.0)
    assert branch.columns["p"][0] == 0.0


def test_two_events_at_one_point_share_their_row():
    """Two uncoupled oscillators that lose stability together: two labels, one row."""
    equations = {**oscillator("x", "y", "p"), **oscillator("u", "v", "p", "1.7")}
    branch = follow(equations, dict.fromkeys(equations, 0.0), {"p": -1.0}, (-1.0, 1.0))
    assert [p.label for p in branch.points] == ["HB1", "HB2"]
    assert branch.points[0].index == branch.points[1].index
    assert np.all(np.diff(branch.columns["p"]) > 0.0)


def test_a_labelled_zero_is_written_as_zero():
    branch = follow(FOLD, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.5))
    assert str(branch["LP1"].values["p"]) == "0.0"


def test_a_state_that_grows_for_ever_while_the_parameter_tends_to_its_bound_ends_there():
    """p = x exp(-x): fold at x = 1, p = 1/e, then p -> 0 as x grows."""
    line = follow({"x": "p*exp(x) - x"}, {"x": 0.0}, {"p": 0.0}, (0.0, 4.0))
    assert [end.reason for end in line.ends] == ["bound", "bound"]
    assert "approaches 0 ever more closely" in line.ends[1].text
    assert [point.type for point in line.points] == ["LP"]
    assert line.points[0].values["p"] == pytest.approx(0.36787944117144233, abs=1e-12)
    assert line.steps < 140
    assert 0 < line.columns["p"][-1] < 1e-9


def test_a_fold_on_the_bound_is_passed():
    """p = x^2 turns at p = 0, the bound: both halves are one branch."""
    line = follow(FOLD, {"x": 1.0}, {"p": 1.0}, (0.0, 1.0))
    assert [point.type for point in line.points] == ["LP"]
    assert sorted(line.columns["x"][[0, -1]]) == pytest.approx([-1, 1])
