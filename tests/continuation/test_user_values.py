"""User values are hit wherever they are on the branch."""

import pytest

import contin
from contin.model.model import Model
from tests.problems.follow import follow


@pytest.mark.parametrize("value", [0.001, 0.01, 0.03, -0.02])
def test_a_user_value_in_the_same_step_as_a_branch_point_is_hit(value):
    # x' = p x - x^3: a branch point at p = 0, where Newton on the curve fails
    branch = follow({"x": "p*x - x^3"}, {"x": 0.0}, {"p": -1.0}, (-1.0, 1.0), values={"p": [value]})
    assert [p.type for p in branch.points] == (["BP", "UZ"] if value > 0 else ["UZ", "BP"])
    uz = next(p for p in branch.points if p.type == "UZ")
    assert uz.values["p"] == value


@pytest.mark.seldom
def test_user_values_in_every_step_leave_the_bifurcations_as_they_are():
    # x' = p - x^2 has a fold at p = 0; y' = (p - 1/2) y + .. a branch point, z, w a Hopf point, at p = 0.7
    rhs = {
        "x": "p - x^2", "y": "(p - 0.5)*y - y^3",
        "z": "(p - 0.7)*z - 2*w - z*(z^2 + w^2)", "w": "2*z + (p - 0.7)*w - w*(z^2 + w^2)",
    }  # fmt: skip
    values = [(k + 0.5) / 200 for k in range(200)]
    start = {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}
    alone = follow(rhs, start, {"p": 1.0}, (-1.0, 1.0))
    branch = follow(rhs, start, {"p": 1.0}, (-1.0, 1.0), values={"p": values})
    events = [p for p in branch.points if p.type != "UZ"]
    assert [p.type for p in events] == [p.type for p in alone.points] == ["HB", "BP", "LP", "BP", "HB"]
    assert [p.values["p"] for p in events] == pytest.approx([0.7, 0.5, 0.0, 0.5, 0.7], abs=1e-10)
    assert sum(p.type == "UZ" for p in branch.points) == 2 * len(values)
    assert [end.reason for end in branch.ends] == [end.reason for end in alone.ends]
    assert branch.notes == alone.notes


def test_a_user_value_where_two_branches_cannot_be_told_apart_is_a_note():
    # x' = x (x - p^2): x = 0 and x = p^2 touch at p = 0
    values = [-0.8, 0.005, 0.8]
    branch = follow({"x": "x*(x - p^2)"}, {"x": 0.0}, {"p": -1.0}, (-1.0, 1.0), values={"p": values})
    found = {p.values["p"] for p in branch.points if p.type == "UZ"}
    assert {-0.8, 0.8} <= found
    assert all(v in found or any(f"p = {v} is not labelled" in note for note in branch.notes) for v in values)


def test_a_closed_curve_that_starts_at_a_value_has_it_once_and_exactly():
    """The column x of the circle is 0.8 at p = -0.6 and at the start, p = 0.6."""
    model = Model(
        "circle", states={"x": 0.8}, parameters={"p": 0.6}, equations={"x": "x^2 + p^2 - 1"}, kind="algebraic"
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.2, 1.2), values={"x": [0.8]})
    values = sorted((point.values["p"], point.error) for point in line.points if point.type == "UZ")
    assert [place for place, _ in values] == pytest.approx([-0.6, 0.6], abs=1e-12)
    assert max(error for _, error in values) <= 1e-12


@pytest.mark.parametrize("e", [0.02, 1e-3, 1e-5])
def test_a_column_that_takes_a_value_three_times_within_a_step(e):
    at = [0.2137, 0.2137 + e, 0.2137 + 2.7 * e]
    height = "*".join(f"(x - {a!r})" for a in at)
    model = contin.Model(
        "bent", states={"x": 0.0}, parameters={"p": -1.0}, equations={"x": "p - x"}, observables={"h": height}
    )
    branch = contin.continuation(contin.equilibrium(model, {"x": -1.0}), "p", (-1.0, 1.5), values={"h": [0.0]})
    assert [point.type for point in branch.points] == ["UZ"] * 3
    for point, place in zip(branch.points, at, strict=True):
        assert abs(point.values["p"] - place) <= 1e-9 * e + 1e-14


@pytest.mark.parametrize(("direction", "label", "value"), [("up", "UZ", 1.5), ("down", "LP", 0.0)])
def test_a_run_stops_at_the_first_point_of_a_type_that_it_is_asked_to(direction, label, value):
    """p = x^2 from x = 1: the user value 1.5 on one side, the fold on the other."""
    model = contin.Model("m", states={"x": 1.0}, parameters={"p": 1.0}, equations={"x": "p - x^2"})
    settings = {"stop_at": ["UZ", "LP"]}
    branch = contin.continuation(
        contin.equilibrium(model), "p", (-1.0, 2.0), values={"p": [1.5, 1.7]}, direction=direction, settings=settings
    )
    assert [(point.type, point.values["p"]) for point in branch.points] == [(label, pytest.approx(value, abs=1e-12))]
    row = -1 if direction == "up" else 0
    assert branch.ends[row].reason == label.lower()
    assert branch.columns["p"][row] == pytest.approx(value, abs=1e-12)
