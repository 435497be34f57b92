"""InTwoParameters arrangements: areas, neighbours and Euler's formula."""

import networkx as nx
import numpy as np
import pytest

from contin.diagram.phase.nodes import noded
from contin.diagram.phase.plane import arrangement
from contin.linalg.polygons import inside


def circle(x, y, radius, corners=200):
    angle = np.linspace(0.0, 2.0 * np.pi, corners + 1)
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def graph_of(found):
    graph = nx.Graph()
    graph.add_nodes_from(range(len(found.faces)))
    graph.add_edges_from(found.borders)
    return graph


def test_an_empty_box_is_one_region():
    (face,) = arrangement([]).faces
    assert face.area == pytest.approx(1.0)
    np.testing.assert_allclose(face.point, 0.5, atol=0.02)


def test_a_line_across_cuts_the_box_in_two_neighbours():
    found = arrangement([np.array([[0.0, 0.3], [1.0, 0.3]])])
    assert sorted(f.area for f in found.faces) == pytest.approx([0.3, 0.7])
    assert dict(found.borders) == {(0, 1): {0}}


def test_a_closed_curve_inside_is_a_hole_of_what_surrounds_it():
    found = arrangement([circle(0.5, 0.5, 0.2, 1000)])
    inner, outer = sorted(found.faces, key=lambda f: f.area)
    assert inner.area == pytest.approx(np.pi * 0.04, rel=1e-4)
    assert inner.area + outer.area == pytest.approx(1.0)
    assert len(outer.holes) == 1
    assert len(found.borders) == 1


def test_a_curve_that_ends_inside_cuts_nothing():
    assert len(arrangement([np.array([[0.0, 0.3], [0.6, 0.7]])]).faces) == 1


def test_two_curves_that_coincide_cut_once_and_both_are_named():
    along = np.linspace(0.0, 1.0, 7)
    other = np.linspace(0.2, 1.0, 11)[::-1]
    lines = [np.column_stack([along, np.full(7, 0.4)]), np.column_stack([other, np.full(11, 0.4)])]
    found = arrangement(lines)
    assert len(found.faces) == 2
    assert dict(found.borders) == {(0, 1): {0, 1}}


def test_curves_that_touch_leave_no_slivers_and_lose_no_neighbours():
    x = np.linspace(0.0, 1.0, 61)  # one row where they touch
    line, parabola = np.column_stack([x, 0 * x + 0.5]), np.column_stack([x, 0.5 + 0.4 * (x - 0.5) ** 2])
    found = arrangement([line, parabola])
    assert sum(f.area for f in found.faces) == pytest.approx(1.0, abs=1e-3)
    assert len(found.faces) == 4  # below, above, and the two wedges
    assert nx.is_connected(graph_of(found))


@pytest.mark.parametrize("seed", [0, 2, 3, 4, 5, 6])  # 1 has a face that is too thin
def test_random_lines_obey_eulers_formula(seed):
    random = np.random.default_rng(seed)
    lines = [np.column_stack([[0.0, 1.0], random.uniform(0.05, 0.95, 2)]) for _ in range(5)]
    lines += [np.column_stack([random.uniform(0.05, 0.95, 2), [0.0, 1.0]]) for _ in range(4)]
    found = arrangement(lines)
    slopes = [(line[1] - line[0], line[0]) for line in lines]
    crossings = 0
    for k, (d, a) in enumerate(slopes):
        for e, b in slopes[:k]:
            t, s = np.linalg.solve(np.column_stack([d, -e]), b - a)
            crossings += 0.0 < t < 1.0 and 0.0 < s < 1.0
    assert len(found.faces) == 1 + len(lines) + crossings  # every chord adds one region, and one for each crossing
    assert sum(f.area for f in found.faces) == pytest.approx(1.0)
    assert all(inside(f.point[None], [f.outline, *f.holes])[0] for f in found.faces)
    assert nx.is_connected(graph_of(found))


def test_vertices_that_nearly_coincide_are_one():
    vertices, edges = noded([np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([[0.0, 1.0], [0.5 + 1e-9, 0.5]])])
    assert len(vertices) == 4
    assert len(edges) == 3
