"""A diagram as an object: graph, report, growing by hand, budgets, interruption."""

from itertools import pairwise

import networkx as nx
import pytest

import contin
from contin.continuation.seed import Seed
from contin.errors import InputError
from tests.diagram.crossings import assert_same_points, explore, model, solutions

R = (-1.0, 1.5)
FORK = {"x": "p*x - x^3"}


@pytest.fixture(scope="module")
def fork():
    return explore(FORK, {"x": 0.0}, {"p": -1.0}, R)


def test_graph_of_a_pitchfork_is_a_star_with_four_rays(fork):
    graph = fork.graph
    assert isinstance(graph, nx.MultiGraph)
    centre = [n for n, data in graph.nodes(data=True) if data["type"] == "BP"]
    assert len(centre) == 1
    assert graph.degree(centre[0]) == 4
    assert graph.number_of_edges() == 4
    assert nx.is_tree(nx.Graph(graph))
    assert graph.nodes[centre[0]]["labels"] == ["start.BP1"]
    assert sorted(data["stable"] for *_, data in graph.edges(data=True)) == [False, True, True, True]


def test_graph_of_a_loop_on_a_line_has_a_cycle():
    """x (1 - p^2 - x^2): between the two branch points run the line and both halves of the circle."""
    graph = explore({"x": "x*(1 - p^2 - x^2)"}, {"x": 0.0}, {"p": -2.0}, (-2.0, 2.0)).graph
    a, b = (n for n, data in graph.nodes(data=True) if data["type"] == "BP")
    assert graph.number_of_edges(a, b) == 3
    assert len(nx.cycle_basis(nx.Graph(graph))) == 0  # all cycles are pairs of parallel edges
    assert graph.number_of_edges() == 5


def test_edges_cover_every_row_of_every_branch_once(fork):
    assert len(fork) > 1
    for branch in fork:
        pieces = sorted(d["rows"] for *_, d in fork.graph.edges(data=True) if d["branch"] == branch.name)
        assert pieces[0][0] == 0
        assert pieces[-1][1] == len(branch) - 1
        assert all(a[1] == b[0] for a, b in pairwise(pieces))


def test_report_names_branches_points_and_ends(fork):
    text = str(fork)
    assert text.startswith("2 branches in p from -1 to 1.5")
    assert "start/BP1: equilibrium, born at start.BP1" in text
    assert "pitchfork" in text
    assert "supercritical" in text
    assert "p reached 1.5" in text


def test_extending_an_end_goes_on_from_its_last_row_and_finds_what_is_there():
    """x (p - x^2)(4 - p): beyond p = 1.5 there is a second branch point at p = 4, of a vertical line."""
    diagram = explore({"x": "(p*x - x^3)*(4 - p)"}, {"x": 0.0}, {"p": -1.0}, R)
    start = diagram["start"]
    piece = diagram.extend("start", "last", (-1.0, 5.0))
    assert piece.z[0] == pytest.approx(start.z[-1])
    assert piece.z[-1, -1] == 5.0
    assert [p.values["p"] for p in piece.points] == pytest.approx([4.0])
    assert any(b.parent and b.parent.branch == piece.name for b in diagram)
    back = diagram.extend("start", "first", (-3.0, 1.5))
    assert back.z[-1, -1] == -3.0
    with pytest.raises(InputError, match="first"):
        diagram.extend("start", "middle")


def test_what_a_budget_left_can_be_followed_by_hand():
    diagram = explore(FORK, {"x": 0.0}, {"p": -1.0}, R, budget={"branches": 1})
    assert [b.name for b in diagram] == ["start"]
    assert diagram.notes == ["budget of 1 branches used; not followed: start/BP1"]
    diagram.explorer.budget = type(diagram.explorer.budget)()
    added = diagram.follow("start", "BP1")
    assert [b.name for b in added] == ["start/BP1"]
    assert diagram.follow("start", "BP1") == []  # it is in the diagram now


def test_budget_of_steps_stops_the_exploration():
    diagram = explore(FORK, {"x": 0.0}, {"p": -1.0}, R, budget={"steps": 5})
    assert len(diagram) == 1
    assert diagram.notes[0].startswith("budget of 5 steps")
    with pytest.raises(InputError, match="unknown branch"):
        explore(FORK, {"x": 0.0}, {"p": -1.0}, R, budget={"branch": 5})


def test_interruption_keeps_what_was_computed_and_the_diagram_says_so():
    seen = []

    def watch(progress):
        seen.append(progress)
        if len(seen) == 3:
            raise KeyboardInterrupt

    diagram = explore(FORK, {"x": 0.0}, {"p": -1.0}, R, watch=watch)
    assert "stopped" in {e.reason for e in diagram.branches[-1].ends}
    assert "stopped by the user" in diagram.notes
    assert sum(len(b) for b in diagram) > 2


def test_interruption_between_branches_keeps_the_branches_before(monkeypatch):
    whole = explore(FORK, {"x": 0.0}, {"p": -1.0}, R)
    assert not whole.stopped

    def known(explorer, diagram, seed):
        if seed.born:
            raise KeyboardInterrupt

    monkeypatch.setattr(type(whole.explorer), "_known", known)
    first = Seed(whole["start"].problem, whole["start"].z[0])
    cut = whole.explorer.explore([("start", first)], reserve=[first])
    assert [b.name for b in cut] == ["start"]
    assert cut.stopped
    assert cut.notes[-1] == "stopped by the user"


def test_two_starts_on_one_branch_are_one_branch():
    diagram = explore(FORK, {"x": 0.0}, {"p": -1.0}, R, start=[{"x": 0.0}, {"x": 1e-3}])
    assert len(diagram) == 2
    assert "start 'start2' lies on branch 'start1'" in diagram.notes


def test_a_start_without_solution_is_a_note_and_the_others_are_followed():
    diagram = explore({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, R, start=[{"x": 1.0}, {"x": -1.0}])
    assert len(diagram) == 1
    with pytest.raises(contin.ContinError):
        explore({"x": "p - x^2"}, {"x": 1.0}, {"p": -1.0}, R)


def test_unknown_branch_lists_the_known_ones(fork):
    with pytest.raises(KeyError, match="start/BP1"):
        fork["nowhere"]


def test_branch_point_that_breaks_a_declared_symmetry_gives_an_image_with_mapped_points():
    """Secondary pitchfork on the x-branch: its image has the same labels at mirrored states."""
    diagram = contin.diagram(
        model(
            {"x": "p*x - x^3 - 2*x*y^2", "y": "(p - 0.2)*y - y^3 - 2*y*x^2"}, {"x": 0.0, "y": 0.0}, {"p": -1.0},
            symmetries={"sy": {"y": "-y"}},
        ),
        "p", (-1.0, 3.0),
    )  # fmt: skip
    images = [b for b in diagram if b.image_of is not None]
    assert images
    for image in images:
        original = diagram[image.image_of.branch]
        assert image.effort == {}
        assert (image.columns["p"] == original.columns["p"]).all()
        assert image.columns["y"] == pytest.approx(-original.columns["y"])
        assert [(p.label, p.values["p"]) for p in image.points] == [(p.label, p.values["p"]) for p in original.points]


def test_images_of_one_line_under_several_symmetries_are_one_branch():
    """Pitchforks with the symmetry of the square: two axes and two diagonals, each pair computed once."""
    square = {"x": "p*x - x^3 - x*y^2/2", "y": "p*y - y^3 - y*x^2/2"}
    symmetries = {"flip": {"x": "-x"}, "swap": {"x": "y", "y": "x"}}
    diagram = explore(square, {"x": 0.0, "y": 0.0}, {"p": -1.0}, R, symmetries=symmetries)
    assert [b.image_of is None for b in diagram] == [True, True, False, True, False]
    a, d = 0.5**0.5, (0.5 / 1.5) ** 0.5
    axes = [(a, 0), (-a, 0), (0, a), (0, -a)]
    assert_same_points(solutions(diagram, 0.5), [(0, 0), *axes, (d, d), (d, -d), (-d, d), (-d, -d)])


@pytest.mark.parametrize("budget", [1, 2, 12, 25])
def test_no_branch_takes_more_steps_than_the_budget_has_left(budget):
    diagram = explore(FORK, {"x": 0.0}, {"p": -1.0}, R, budget={"steps": budget}, settings={"max_step": 0.01})
    assert budget - 1 <= sum(branch.steps for branch in diagram) <= budget
    assert any("ends there" in note for note in diagram.unfinished)
