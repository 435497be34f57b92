"""The explorer finds every branch once: its branches pass through each equilibrium exactly once."""

from itertools import product
from math import sqrt

import numpy as np
import pytest

from tests.diagram.crossings import assert_same_points, explore, solutions
from tests.problems.cases import zeros

R = (-1.0, 1.5)
AT = {"p": -1.0}


def cubic_roots(p):
    return [0.0, sqrt(p), -sqrt(p)] if p > 0 else [0.0]


def ring(n, coupling):
    return {f"u{k}": f"p*u{k} - u{k}^3 + {coupling}*(u{(k + 1) % n} + u{(k - 1) % n} - 2*u{k})" for k in range(n)}


def by_search(equations, names, p, radius=2.0, starts=4000):
    """Equilibria from Newton's method at many random starts: an independent, if slow, way to find them all."""
    import contin

    system = contin.equilibrium(
        contin.Model("search", states=zeros(names), parameters={"p": p}, equations=equations)
    ).system
    rng = np.random.default_rng(0)
    n = len(names.split())
    found: list[np.ndarray] = []
    for u in rng.uniform(-radius, radius, (starts, n)):
        for _ in range(60):
            f, jacobian = system.jacobian(u, np.array([p]))
            step = np.linalg.solve(jacobian[:, :n], -f)
            u = u + step * min(1.0, 1.0 / max(np.abs(step).max(), 1e-300))
            if np.abs(step).max() < 1e-13:
                if all(np.abs(u - v).max() > 1e-7 for v in found):
                    found.append(u)
                break
    return np.array(found)


@pytest.mark.parametrize("names", ["x", "x y", "x y z"])
def test_uncoupled_pitchforks_give_three_to_the_n_equilibria(names):
    """One branch point with a kernel of dimension n, (3^n - 1)/2 branches beside rest."""
    states = names.split()
    diagram = explore({s: f"p*{s} - {s}^3" for s in states}, zeros(names), AT, R)
    assert len(diagram) == 1 + (3 ** len(states) - 1) // 2
    assert [p.type for p in diagram["start"].points] == ["BP"]
    assert_same_points(solutions(diagram, 0.81), list(product(cubic_roots(0.81), repeat=len(states))))


@pytest.mark.parametrize(
    ("symmetries", "computed"),
    [({}, 5), ({"mirror": {"x": "-x"}}, 5), ({"mirror": {"x": "-x"}, "flip": {"y": "-y"}}, 4),
     ({"mirror": {"x": "-x"}, "flip": {"y": "-y"}, "swap": {"x": "y", "y": "x"}}, 3)],
    ids=["none", "x", "x and y", "square"],
)  # fmt: skip
def test_declared_symmetries_save_work_and_lose_no_branch(symmetries, computed):
    """p x - x^3 twice has the symmetry of a square: what is not computed is an image, and every solution is there."""
    diagram = explore({"x": "p*x - x^3", "y": "p*y - y^3"}, zeros("x y"), AT, R, symmetries)
    assert sum(b.image_of is None for b in diagram) <= computed
    assert_same_points(solutions(diagram, 0.81), list(product(cubic_roots(0.81), repeat=2)))


def test_opposite_pitchforks_from_one_point():
    """p x - x^3 to the right, -p y - y^3 to the left of one branch point with a kernel of dimension 2."""
    diagram = explore({"x": "p*x - x^3", "y": "-p*y - y^3"}, zeros("x y"), AT, R)
    assert_same_points(solutions(diagram, 0.81), [[0, 0], [0.9, 0], [-0.9, 0]])
    assert_same_points(solutions(diagram, -0.81), [[0, 0], [0, 0.9], [0, -0.9]])


def test_three_transcritical_branches_with_the_symmetry_of_a_triangle():
    """p z + conj(z)^2 - z |z|^2: on the axes at angles 0, 120, 240 degrees r solves p + r - r^2 = 0."""
    diagram = explore({"x": "p*x + x^2 - y^2 - x*(x^2 + y^2)", "y": "p*y - 2*x*y - y*(x^2 + y^2)"}, zeros("x y"), AT, R)
    r = [(1 + s * sqrt(1 + 4 * 0.5)) / 2 for s in (1, -1)]
    angles = 2 * np.pi * np.arange(3) / 3
    expected = [[0, 0]] + [[q * np.cos(a), q * np.sin(a)] for q in r for a in angles]
    assert_same_points(solutions(diagram, 0.5), expected)
    folds = [p.values["p"] for b in diagram for p in b.points if p.type == "LP"]
    assert folds == pytest.approx([-0.25] * 3, abs=1e-12)


@pytest.mark.parametrize("symmetries", [None, {"sx": {"x": "-x"}, "sy": {"y": "-y"}}], ids=["computed", "mirrored"])
def test_secondary_branches_of_competing_modes(symmetries):
    """p x - x^3 - 2 x y^2, (p - 1/5) y - y^3 - 2 y x^2: mixed modes 3 y^2 = p + 1/5, 3 x^2 = p - 2/5."""
    diagram = explore(
        {"x": "p*x - x^3 - 2*x*y^2", "y": "(p - 0.2)*y - y^3 - 2*y*x^2"}, zeros("x y"), AT, (-1.0, 3.0), symmetries
    )
    p = 1.3
    x, y = sqrt((p - 0.4) / 3), sqrt((p + 0.2) / 3)
    expected = [[0, 0], [sqrt(p), 0], [-sqrt(p), 0], [0, sqrt(p - 0.2)], [0, -sqrt(p - 0.2)]]
    expected += [[a * x, b * y] for a in (1, -1) for b in (1, -1)]
    assert_same_points(solutions(diagram, p), expected)
    at = sorted({round(q.values["p"], 9) for b in diagram for q in b.points})
    assert at == [0.0, 0.2, 0.4]


def test_closed_loop_between_two_branch_points():
    """x (1 - p^2 - x^2): a circle that meets rest at p = -1 and 1."""
    diagram = explore({"x": "x*(1 - p^2 - x^2)"}, zeros("x"), {"p": -2.0}, (-2.0, 2.0))
    assert [b.name for b in diagram] == ["start", "start/BP1"]
    assert [e.reason for e in diagram["start/BP1"].ends] == ["closed", "closed"]
    assert [p.values["p"] for p in diagram["start/BP1"].points] == pytest.approx([1.0])
    assert_same_points(solutions(diagram, 0.6), [[0], [0.8], [-0.8]])


def test_half_of_a_loop_when_the_other_half_is_its_mirror_image():
    diagram = explore({"x": "x*(1 - p^2 - x^2)"}, zeros("x"), {"p": -2.0}, (-2.0, 2.0), {"flip": {"x": "-x"}})
    assert [(b.name, b.image_of is None) for b in diagram] == [
        ("start", True), ("start/BP1", True), ("start/BP1~flip", False)
    ]  # fmt: skip
    assert diagram["start/BP1"].ends[1].reason == "joined"
    assert_same_points(solutions(diagram, 0.6), [[0], [0.8], [-0.8]])


def test_lines_that_cross_each_other_are_each_followed_once():
    """(p - x)(p + x)(p - 2x - 1) = 0: three lines, three crossings at p = 0, -1 and 1/3."""
    diagram = explore({"x": "(p - x)*(p + x)*(p - 2*x - 1)"}, {"x": -2.0}, {"p": -2.0}, (-2.5, 2.5))
    assert len(diagram) == 3
    points = {round(q.values["p"], 9) for b in diagram for q in b.points}
    assert points == {0.0, -1.0, round(1 / 3, 9)}
    assert_same_points(solutions(diagram, 1.7), [[1.7], [-1.7], [0.35]])


def test_parabola_line_and_circle():
    diagram = explore({"x": "(p - x^2 + 0.5)*x*(x^2 + p^2 - 1)"}, zeros("x"), {"p": -2.0}, (-2.5, 2.5))
    assert len(diagram) == 3
    assert_same_points(solutions(diagram, 0.1), [[0], [sqrt(0.6)], [-sqrt(0.6)], [sqrt(0.99)], [-sqrt(0.99)]])


def test_figure_of_eight_crosses_itself_and_is_one_branch():
    diagram = explore({"x": "x^4 - x^2 + p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 2.0))
    assert len(diagram) == 1
    p = 0.3
    squares = [(1 + s * sqrt(1 - 4 * p * p)) / 2 for s in (1, -1)]
    assert_same_points(solutions(diagram, p), [[s * sqrt(q)] for q in squares for s in (1, -1)])


def test_angles_are_identified_modulo_their_period():
    """sin x (p - cos x): rest at 0 and pi, joined by the loop p = cos x that winds once."""
    diagram = explore(
        {"x": "p*sin(x) - sin(x)*cos(x)"}, {"x": {"value": 0.0, "period": "2*pi"}}, {"p": -2.0}, (-2.0, 2.0)
    )
    assert len(diagram) == 3
    found = solutions(diagram, 0.3)
    assert sorted(np.abs(found[:, 0])) == pytest.approx([0.0, np.arccos(0.3), np.arccos(0.3), np.pi])
    assert [p.type for b in diagram for p in b.points] == ["BP", "BP"]


@pytest.mark.seldom
def test_all_equilibria_of_a_ring_of_three_cells():
    """Kernel of dimension 2 at p = 3 d; the branches against Newton's method from many random starts."""
    equations = ring(3, 0.2)
    diagram = explore(equations, zeros("u0 u1 u2"), AT, (-1.0, 2.0))
    assert_same_points(solutions(diagram, 0.9), by_search(equations, "u0 u1 u2", 0.9, starts=1500))


@pytest.mark.parametrize("cells", [6, pytest.param(8, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_branches_that_only_the_order_of_the_ring_tells_apart(cells):
    """First branch point with wave number 1: its kernel has dimension 2, and 2 n half-branches are n whole ones."""
    names = " ".join(f"u{k}" for k in range(cells))
    d = 0.2 * (2 - 2 * np.cos(2 * np.pi / cells))
    diagram = explore(ring(cells, 0.2), zeros(names), {"p": 0.5 * d}, (0.5 * d, 2.0 * d), start=zeros(names))
    assert [p.type for p in diagram["start"].points] == ["BP"]
    found = solutions(diagram, 1.8 * d)
    assert len(found) == 1 + 2 * cells
    for image in (np.roll(found, 1, axis=1), found[:, ::-1], -found):
        assert_same_points(found, image)


@pytest.mark.seldom
def test_rotating_a_solution_of_a_ring_of_four_cells_gives_a_solution_of_the_diagram():
    """No symmetry is declared: every solution's orbit under rotation, reflection and sign is found."""
    names = "u0 u1 u2 u3"
    diagram = explore(ring(4, 0.2), zeros(names), AT, (-1.0, 1.3))
    found = solutions(diagram, 1.1)
    for image in (np.roll(found, 1, axis=1), found[:, ::-1], -found):
        assert_same_points(found, image)


@pytest.mark.seldom
def test_continuous_symmetry_gives_one_representative():
    """p z - z |z|^2: a circle of equilibria; one branch stands for it and says why it ends."""
    diagram = explore({"x": "p*x - x*(x^2 + y^2)", "y": "p*y - y*(x^2 + y^2)"}, zeros("x y"), AT, R)
    assert [b.name for b in diagram] == ["start", "start/BP1"]
    end = diagram["start/BP1"].ends[1]
    assert end.reason == "corrector"
    assert "continuous symmetry" in end.text
