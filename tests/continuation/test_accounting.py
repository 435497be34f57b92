"""Between neighbouring rows the change of `unstable` is explained by the labels between them."""

from dataclasses import replace

import numpy as np
import pytest

import contin
from contin.continuation.accounting import turns_again, unexplained
from contin.continuation.outcome import Verified
from contin.continuation.rows import Rows
from contin.continuation.segment import Row, Segment
from contin.model.model import Model


def label(type_: str, **vectors: object) -> Verified:
    return Verified(type_, np.zeros(2), 0.0, 0.0, np.zeros(1, complex), 0, vectors=vectors)


@pytest.mark.parametrize(
    ("unstable", "labels", "expected"),
    [
        ([0, 0, 0], [], []),
        ([0, 0, 1], [], [2]),
        ([0, 0, 1], [(1, label("LP"))], []),
        ([0, 0, 2], [(1, label("LP"))], [2]),
        ([0, 0, 2], [(1, label("HB"))], []),
        ([0, 0, 4], [(1, label("HB"))], [2]),
        ([0, 0, 4], [(1, label("HB", kernel=2))], []),
        ([0, 0, 0, 4], [(1, label("HB")), (2, label("HB"))], []),
        ([0, 2, 0, 1, 1], [(3, label("BP"))], [1, 2]),
        ([1, 0, 3], [], [1, 2]),
    ],
)
def test_every_change_needs_a_label(unstable, labels, expected):
    assert unexplained(np.array(unstable), [(*item, 1.0) for item in labels]) == expected


def test_a_corner_explains_the_jump_there_and_no_other_change():
    unstable = np.array([0] * 10 + [2] * 10 + [3] * 10)
    assert unexplained(unstable, [], [], [10]) == [20]
    assert unexplained(unstable, [], [], [20]) == [10]
    assert unexplained(unstable, [], [], [10, 20]) == []


@pytest.mark.parametrize("row", range(7, 14))
def test_rows_next_to_a_corner_may_lie_on_either_arm_and_on_no_third(row):
    """The corner of equations lies at row 10; the corrector may put a row within three of it on the other arm."""
    for arms in ((0, 2), (1, 1)):
        unstable = np.array([arms[0]] * 10 + [arms[1]] * 11)
        unstable[row] = arms[row < 10]
        assert unexplained(unstable, [], [], [10]) == []
        unstable[row] = 5
        assert unexplained(unstable, [], [], [10]) == [row, row + 1]


def test_rows_farther_from_a_corner_are_not_excused():
    unstable = np.array([0] * 10 + [2] * 11)
    unstable[5] = 2
    assert unexplained(unstable, [], [], [10]) == [5, 6]


def segment(*unstable: int, marks: tuple[int, ...] = (), jumps: tuple[int, ...] = ()) -> Segment:
    count, zeros = len(unstable), np.zeros((len(unstable), 2))
    z = zeros + np.arange(count)[:, None]
    found = tuple(Row(k, 0.0, replace(label("LP"), z=np.array([k - 1.5, 0.0])), np.zeros(2)) for k in marks)
    values = np.zeros((count, 1), complex)
    return Segment(z, zeros, np.array(unstable), values, np.ones(2), found, jumps=jumps)


def test_jumps_keep_their_place_among_labelled_rows_and_when_the_order_turns_round():
    rows = Rows()
    rows.add_segment(segment(0, 0, 0))
    rows.add_segment(
        segment(0, 1, 1, 3, marks=(2,), jumps=(4,))
    )  # labelled between 0 and 1; a jump before the last row
    jumped = rows.joined(0)[0][2]
    assert np.flatnonzero(np.diff(jumped) == 2).tolist() == [rows.jumps[0] - 1]
    rows.reverse()
    jumped = rows.joined(0)[0][2]
    assert np.flatnonzero(np.diff(jumped) == -2).tolist() == [rows.jumps[0] - 1]


def test_a_jump_at_a_corner_needs_no_label():
    model = Model(
        "corner", states={"x": -1.0, "y": 0.0}, parameters={"p": -1.0},
        equations={"x": "p - x", "y": "(1 if x > 0.3 else -1)*y"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    assert branch.unexplained == 0
    assert any("jumps at a corner" in note for note in branch.notes)
    assert branch.columns["unstable"][[0, -1]].tolist() == [0, 1]


def test_the_critical_values_of_a_birth_are_not_counted():
    assert unexplained(np.array([1, 0, 1]), [], [1]) == []


@pytest.mark.parametrize(
    ("unstable", "types", "expected"),
    [
        ([0, 0, 0, 2], ["HB", "HB"], [3]),  # two pairs change nothing or four
        ([0, 0, 0, 0], ["HB", "HB"], []),
        ([2, 0, 0, 2], ["HB", "LP"], [3]),
        ([0, 0, 0, 0], ["PD", "LP"], []),
        ([0, 0, 0, 0], ["UZ", "LP"], [3]),
        ([0, 0, 0, 3], ["NS", "PD"], []),
    ],
)
def test_labels_explain_sums_of_what_each_changes_and_no_other_number(unstable, types, expected):
    labels = [(row, label(type_), 1.0) for row, type_ in enumerate(types, start=1)]
    assert unexplained(np.array(unstable), labels) == expected


@pytest.mark.parametrize(
    ("slope", "expected"),
    [(0.0, [[], [2]]), (1e-3, [[], []]), (0.5, [[2], []])],  # turns there, may, is crossed
)
def test_a_pitchfork_changes_only_the_branch_that_is_crossed(slope, expected):
    pitchfork = replace(label("BP"), normal_form={"kind": "pitchfork"})
    found = [unexplained(np.array([0, 0, changed]), [(1, pitchfork, slope)]) for changed in (0, 1)]
    assert found == expected


@pytest.mark.parametrize(
    ("equations", "start"),
    [
        ({"x": "p*x - x^3"}, {"x": 1.0}),
        ({"x": "p*x - x^3", "y": "x^2 - y"}, {"x": 1.0, "y": 1.0}),
        ({"x": "p*x - x^3", "y": "2*y - x^2"}, {"x": 1.0, "y": 0.5}),
        ({"x": "p*(2 - p)*x - x^3"}, {"x": 1.0}),  # closed, through two pitchforks
    ],
)
def test_a_fork_that_is_followed_through_its_pitchfork_needs_no_note(equations, start):
    model = Model("fork", states=dict.fromkeys(equations, 0.0), parameters={"p": 1.0}, equations=equations)
    fork = contin.continuation(contin.equilibrium(model, start), "p", (-1.0, 3.0))
    assert {point.normal_form["kind"] for point in fork.points if point.type == "BP"} == {"pitchfork"}
    assert fork.notes == ()
    assert fork.unexplained == 0


def test_a_closed_branch_that_starts_at_a_branch_point_needs_no_note():
    """x^2 = p (2 - p): a circle between two pitchforks, with a further unstable direction."""
    model = Model(
        "ring", states={"x": 0.0, "y": 0.0}, parameters={"p": -0.5}, equations={"x": "p*(2 - p)*x - x^3", "y": "y"}
    )  # fmt: skip
    rest = contin.continuation(contin.equilibrium(model, {"x": 0.0, "y": 0.0}), "p", (-1.0, 3.0))
    assert [(p.label, p.normal_form["kind"]) for p in rest.points] == [("BP1", "pitchfork"), ("BP2", "pitchfork")]
    for label in ("BP1", "BP2"):
        ring = contin.continuation(rest[label].switch(), "p", (-1.0, 3.0))
        assert [end.reason for end in ring.ends] == ["closed", "closed"]
        assert ring.notes == ()
        assert set(ring.columns["unstable"].tolist()) == {1}


def test_a_fold_of_a_complex_equation_is_a_branch_point_with_a_kernel_of_two():
    """z' = p - z^2 in real and imaginary parts: both branches turn at p = 0, and two eigenvalues change sides."""
    model = Model(
        "complex", states={"x": 1.0, "y": 0.0}, parameters={"p": 1.0},
        equations={"x": "p - x^2 + y^2", "y": "-2*x*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 2.0))
    assert [(p.type, p.normal_form["kind"], p.normal_form["kernel"]) for p in line.points] == [("BP", "degenerate", 2)]
    assert sorted(line.columns["unstable"][[0, -1]].tolist()) == [0, 2]
    assert line.unexplained == 0
    other = contin.continuation(line["BP1"].switch(), "p", (-1.0, 2.0))
    assert sorted(other.columns["y"][[0, -1]].tolist()) == pytest.approx([-1.0, 1.0])


def test_a_branch_that_turns_at_its_own_node_has_no_turn_untold():
    """Descartes' folium x^3 + p^3 = 3 x p: one arm passes the node as x = p^2/3, the other turns there, p = x^2/3."""
    model = contin.Model(
        "folium", kind="algebraic", states={"x": 0.03}, parameters={"p": 0.3}, equations={"x": "x^3 + p^3 - 3*x*p"}
    )
    branch = contin.continuation(contin.equilibrium(model), "p", (-1.0, 3.0))
    assert [(point.type, round(point.values["p"], 9)) for point in branch.points] == [
        ("BP", 0.0), ("LP", round(4.0 ** (1.0 / 3.0), 9)),
    ]  # fmt: skip
    assert not branch.notes
    assert not branch.unexplained


@pytest.mark.parametrize(("place", "elsewhere"), [(20, True), (13, True), (12, False), (8, False), (2, True)])
def test_a_turn_beside_a_label_is_no_second_passage_of_it(place, elsewhere):
    """The parameter turns before row 10; a branch point elsewhere along the branch may be what it passes again."""
    columns = {"a": np.linspace(0.0, 1.0, 21) ** 2}
    columns["a"][place] = columns["a"][10]
    assert turns_again(10, columns, [(place, label("BP"), 1.0)]) is elsewhere
