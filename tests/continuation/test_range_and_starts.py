"""Where a branch starts and ends: bounds and user values hit exactly, starts on special points, loops, interruption."""

from math import sqrt

import numpy as np
import pytest

import contin
from contin.errors import InputError, NoSolutionError
from tests.problems.cases import oscillator, zeros
from tests.problems.follow import assert_labels, follow, labels, reasons

R = (-1.0, 1.5)
FOLD = {"x": "p - x^2"}
FORK = {"x": "p*x - x^3"}


def test_bounds_are_rows_to_the_last_bit():
    branch = follow(FOLD, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.4142135))
    assert branch.columns["p"][0] == 1.4142135
    assert branch.columns["p"][-1] == 1.4142135
    assert abs(branch.columns["x"][[0, -1]]) == pytest.approx(sqrt(1.4142135), rel=1e-15)
    assert reasons(branch) == ("bound", "bound")
    assert branch.ends[0].data["value"] == 1.4142135


def test_no_row_leaves_the_range():
    branch = follow(FOLD, {"x": 1.0}, {"p": 1.0}, (0.25, 1.5))
    assert branch.columns["p"].min() == 0.25
    assert branch.columns["p"].max() == 1.5
    assert labels(branch) == []  # the fold at p = 0 is outside


@pytest.mark.parametrize("bound", [0.0, 1e-13, -1e-13, 1e-6, -1e-6])
def test_bound_beside_a_fold(bound):
    """p = x^2: a lower bound above 0 cuts the fold off, one below does not."""
    branch = follow(FOLD, {"x": 1.0}, {"p": 1.0}, (bound, 1.5))
    assert branch.columns["p"].min() >= bound - 1e-15
    if abs(bound) > 1e-9:
        assert labels(branch) == ([] if bound > 0 else [("LP", pytest.approx(0.0, abs=1e-15))])


def test_user_values_of_parameter_state_and_observable_are_hit_exactly():
    branch = follow(
        FOLD, {"x": -1.0}, {"p": 1.0}, R, {"observables": {"cube": "x^3"}},
        values={"p": [0.5, 1.5], "x": [0.25], "cube": [-0.125]},
    )  # fmt: skip
    marked = [p for p in branch.points if p.type == "UZ"]
    at = sorted((p.values["p"], p.values["x"]) for p in marked)
    root = sqrt(0.5)
    wanted = [(0.0625, 0.25), (0.25, -0.5), (0.5, -root), (0.5, root), (1.5, -sqrt(1.5)), (1.5, sqrt(1.5))]
    assert at == [pytest.approx(w, rel=1e-13) for w in wanted]
    assert all(p.values["p"] in (0.5, 1.5) for p in marked if abs(p.values["p"]) > 0.3)
    assert [p.label for p in marked] == [f"UZ{k + 1}" for k in range(6)]
    assert [p.index for p in branch.points] == sorted(p.index for p in branch.points)


def test_user_value_on_the_start_on_a_fold_and_on_a_row_is_marked_once():
    branch = follow(FOLD, {"x": 1.0}, {"p": 1.0}, R, values={"p": [1.0, 0.0]})
    assert [(t, round(v, 12)) for t, v in labels(branch, "LP UZ")].count(("UZ", 1.0)) == 2  # on either side of the fold
    assert labels(branch).count(("LP", pytest.approx(0.0, abs=1e-15))) == 1


@pytest.mark.parametrize(
    ("equations", "states", "p", "expected"),
    [
        (FOLD, {"x": 0.0}, 0.0, [("LP", 0.0)]),
        (FORK, {"x": 0.0}, 0.0, [("BP", 0.0)]),
        ({"x": "p*x - x^2"}, {"x": 0.0}, 0.0, [("BP", 0.0)]),
        (oscillator("x", "y", "p"), zeros("x y"), 0.0, [("HB", 0.0)]),
        ({"x": "1 - x^2 - p^2"}, {"x": 0.0}, 1.0, [("LP", 1.0), ("LP", -1.0)]),
        ({"x": "p*x - x^3", "y": "p*y - y^3"}, zeros("x y"), 0.0, [("BP", 0.0)]),
        ({**oscillator("x", "y", "z"), "z": "p - z^2"}, zeros("x y z"), 0.0, [("LP", 0.0)]),
    ],
    ids=["fold", "pitchfork", "transcritical", "Hopf", "circle at its fold", "kernel 2", "fold with a pair"],
)
def test_start_exactly_on_a_special_point_labels_it_once(equations, states, p, expected):
    branch = follow(equations, states, {"p": p}, (-1.5, 1.5))
    assert_labels(branch, expected)


def test_fold_start_goes_both_ways_down_arm_first_by_the_sign_of_the_state():
    """FORMATS: at a fold the sense is that of the first state that moves."""
    branch = follow(FOLD, {"x": 0.0}, {"p": 0.0}, R)
    assert branch.columns["x"][0] < 0 < branch.columns["x"][-1]
    assert branch.columns["x"][branch.start_row] == 0.0
    up = follow(FOLD, {"x": 0.0}, {"p": 0.0}, R, direction="up")
    assert reasons(up) == ("start", "bound")
    assert (up.columns["x"] >= 0).all()


@pytest.mark.parametrize("direction", ["up", "down", "both"])
def test_start_on_the_edge_of_the_range_has_no_outward_step(direction):
    branch = follow(FORK, {"x": 0.0}, {"p": -1.0}, R, direction=direction)
    if direction == "down":
        assert len(branch) == 1
        assert reasons(branch) in (("bound", "start"), ("bound", "bound"))
    else:
        assert branch.columns["p"][0] == -1.0
        assert branch.columns["p"][-1] == 1.5
        assert reasons(branch)[1] == "bound"


def test_start_outside_the_range_is_bad_input():
    with pytest.raises(InputError, match=r"p = 2, outside the range \[-1, 1.5\]"):
        follow(FORK, {"x": 0.0}, {"p": 2.0}, R)
    with pytest.raises(InputError, match="lower bound must be below"):
        follow(FORK, {"x": 0.0}, {"p": 0.5}, (1.0, 1.0))


def test_start_without_a_solution_says_how_near_it_came():
    with pytest.raises(NoSolutionError, match=r"smallest at x = .*No equilibrium was found around the start either"):
        follow(FOLD, {"x": 1.0}, {"p": -1.0}, (-2.0, 1.0))


def test_branch_whose_state_does_not_move_is_followed_to_both_bounds():
    branch = follow({"x": "p*x - x^3", "y": "-y"}, zeros("x y"), {"p": 0.3}, R)
    assert reasons(branch) == ("bound", "bound")
    assert np.abs(branch.z[:, :2]).max() == 0.0


def test_arms_are_joined_from_the_end_of_the_down_arm_to_the_end_of_the_up_arm():
    branch = follow({"x": "p - x"}, {"x": 0.25}, {"p": 0.25}, R)
    assert (np.diff(branch.columns["p"]) > 0).all()
    assert branch.columns["p"][branch.start_row] == 0.25
    assert (branch.tangents[:, -1] > 0).all()


def test_steps_limit_each_arm_and_are_announced():
    branch = follow({"x": "p - x"}, {"x": 0.25}, {"p": 0.25}, R, settings={"steps": 3})
    assert reasons(branch) == ("steps", "steps")
    assert branch.steps == 6
    assert len(branch) == 7
    none = follow({"x": "p - x"}, {"x": 0.25}, {"p": 0.25}, R, settings={"steps": 0})
    assert len(none) == 1
    assert reasons(none) == ("steps", "steps")


def test_closed_loop_returns_to_its_start_exactly_and_is_not_run_twice():
    branch = follow({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 2.0))
    assert reasons(branch) == ("closed", "closed")
    assert branch.z[0] == pytest.approx(branch.z[-1], abs=1e-9)
    turned = np.unwrap(np.arctan2(branch.columns["x"], branch.columns["p"]))
    assert abs(turned[-1] - turned[0]) == pytest.approx(2 * np.pi, abs=1e-8)


def test_winding_loop_is_unwrapped_by_whole_periods():
    equations = {"x": "sin(x - 2*y)", "y": "p - 0.5*sin(y)"}
    angle = {"value": 0.0, "period": "2*pi"}
    branch = follow(equations, {"x": angle, "y": angle}, {"p": 0.0}, (-1.0, 1.0))
    assert reasons(branch) == ("closed", "closed")
    assert np.abs(branch.z[-1] - branch.z[0]) == pytest.approx([4 * np.pi, 2 * np.pi, 0.0], abs=1e-8)


def test_interruption_keeps_rows_and_labels_and_ends_stopped():
    def watch(progress):
        assert 0.0 <= progress["fraction"] <= 1.0
        assert progress["rows"] > 0
        if "LP" in progress["labels"]:
            raise KeyboardInterrupt

    branch = follow({"x": "p + 3*x - x^3"}, {"x": -2.5}, {"p": -8.125}, (-9.0, 9.0), direction="up", watch=watch)
    assert branch.ends[1].reason == "stopped"
    assert "stopped by the user at p = " in branch.ends[1].text
    assert labels(branch) == [("LP", pytest.approx(2.0, rel=1e-12))]


def test_walk_yields_the_rows_of_one_arm_after_the_start():
    model = contin.Model("m", states={"x": 1.0}, parameters={"p": 1.0}, equations=FOLD)
    start = contin.equilibrium(model)
    points = list(contin.walk(start, "p", R, direction="down"))
    branch = contin.continuation(start, "p", R, direction="down")
    assert [p["p"] for p in points] == branch.columns["p"][: branch.start_row][::-1].tolist()
    assert [p["label"] for p in points if p["label"]] == ["LP"]


def test_walk_goes_along_curves_in_two_parameters():
    model = contin.Model("m", states={"x": 1.0}, parameters={"p": 1.0, "q": 1.0}, equations={"x": "p + q*x - x^3"})
    folds = contin.continuation(contin.equilibrium(model), "p", (-2.0, 2.0))["LP1"].locus()
    ranges = {"p": (-2.0, 2.0), "q": (-1.0, 2.0)}
    arms = [list(contin.walk(folds, ("p", "q"), ranges, direction=way)) for way in ("up", "down")]
    for points in arms:
        assert len(points) > 5
        assert [4.0 * p["q"] ** 3 for p in points] == pytest.approx([27.0 * p["p"] ** 2 for p in points], abs=1e-8)
    assert ["CP"] in [[p["label"] for p in points if p["label"]] for points in arms]


@pytest.mark.parametrize("offset", [1e2, 1e4, 1e6])
def test_states_far_from_zero_are_measured_by_how_they_change(offset):
    """p = (x - X)^2: the same fold wherever the origin of x lies, in about as many steps."""
    branch = follow({"x": "p - (x - X)^2"}, {"x": offset + 1.0}, {"p": 1.0, "X": offset}, (-1.0, 2.0))
    assert_labels(branch, [("LP", 0.0)])
    assert abs(branch["LP1"].values["x"] - offset) < 1e-9 * offset
    assert reasons(branch) == ("bound", "bound")
    assert branch.steps < 100


def test_a_state_far_from_zero_may_travel():
    """x = 1e4 + 1e6 p, bent on the length 1: the metric grows with the way."""
    equation = {"x": "p - 1e-6*(x - 1e4) - 1e-12*sin(x - 1e4)"}
    branch = follow(equation, {"x": 1e4}, {"p": 0.0}, (0.0, 100.0))
    assert branch.columns["x"][-1] == pytest.approx(1e4 + 1e8, rel=1e-6)
    assert reasons(branch) == ("bound", "bound")
    assert branch.steps < 20_000


def test_a_start_at_which_two_pairs_cross_has_each_of_them_once():
    """The first libration point of the restricted three-body problem with damping l: both Hopf points are at l = 0."""
    model = contin.Model(
        "r3b", states={"x": 0.74091, "y": 0, "z": 0, "u": 0, "v": 0, "w": 0}, parameters={"l": 0, "m": 0.04},
        definitions={
            "r1": "sqrt((x + m)^2 + y^2 + z^2)", "r2": "sqrt((x - 1 + m)^2 + y^2 + z^2)",
            "a": "(1 - m)/r1^3", "b": "m/r2^3",
        },
        equations={
            "x": "u", "y": "v", "z": "w", "u": "2*v + x - a*(x + m) - b*(x - 1 + m) + l*u",
            "v": "-2*u + y - (a + b)*y + l*v", "w": "-(a + b)*z + l*w",
        },
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"x": 0.74091}), "l", (-0.1, 0.1))
    assert [point.type for point in line.points] == ["HB", "HB"]
    x = line["HB1"].values["x"]
    c = 0.96 / abs(x + 0.04) ** 3 + 0.04 / abs(x - 0.96) ** 3  # frequencies: sqrt(c), and s^4 + (c - 2) s^2 - ...
    planar = 0.5 * (2 - c + np.sqrt(9 * c * c - 8 * c))
    omegas = sorted(point.normal_form["omega"] for point in line.points)
    assert omegas == pytest.approx(sorted([np.sqrt(c), np.sqrt(planar)]), rel=1e-9)
