"""Coefficients that jump: their place is a node of every mesh; where it moves along a branch nothing is pretended."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import contin
from contin.bvp.changing_formulas import laid
from contin.model.model import Model


def layered(jump: float, right: str) -> Model:
    """u'' = -lam k(x) right(u), k = 1 on [0, jump] and 4 beyond, u = 0 at both ends of [0, 1]."""
    return Model(
        "layered", kind="bvp", time={"name": "x", "from": 0, "to": 1}, states={"u": 0, "v": 0},
        parameters={"lam": 0.5}, conditions=["u(start) = 0", "u(end) = 0"],
        equations={"u": "v", "v": f"-lam*(4 if x > {jump} else 1)*{right}"},
    )  # fmt: skip


def fold_of_exponential(jump: float) -> float:
    """lam of the fold of u'' = -lam k(x) exp(u), by its solutions on both pieces.

    On each, with f = lam k: u = log(2 c^2 / f) - 2 log cosh(c (x - x0)). The slope s at 0 gives the first piece, which
    gives the second one; u(1; s, lam) = 0 and its derivative by s vanishes.
    """

    def onwards(u: float, v: float, f: float, length: float) -> tuple[float, float]:
        c = np.sqrt(f * np.exp(u) / 2.0 + v * v / 4.0)
        t = np.arctanh(v / (2.0 * c))  # c (x0 - x)
        there = t - c * length
        return float(np.log(2.0 * c * c / f) - 2.0 * np.log(np.cosh(there))), float(2.0 * c * np.tanh(there))

    def last(s: float, lam: float) -> float:
        return onwards(*onwards(0.0, s, lam, jump), 4.0 * lam, 1.0 - jump)[0]

    def defining(z: np.ndarray) -> list[float]:
        s, lam = z
        step = 1e-5
        return [last(s, lam), (last(s + step, lam) - last(s - step, lam)) / (2.0 * step)]

    return float(fsolve(defining, [2.8, 1.3], xtol=1e-13)[1])


@pytest.mark.parametrize("jump", [0.47, 0.61803])
def test_fold_beside_a_jump_of_a_coefficient_lies_where_pieces_joined_by_hand_put_it(jump):
    line = contin.continuation(contin.boundary_problem(layered(jump, "exp(u)")), "lam", (0.5, 4.0), direction="up")
    fold = line["LP1"]
    off = abs(fold.values["lam"] - fold_of_exponential(jump))
    assert fold.error < 1e-9  # it was stated as 7e-6 and 6e-8, and off by as much; elsewhere by 1e5 times as much
    assert off <= fold.error + 1e-10  # differences of the reference


def test_modes_of_a_layered_string_are_those_of_its_pieces_joined_by_hand():
    line = contin.continuation(contin.boundary_problem(layered(0.31, "(u - u^3)")), "lam", (0.5, 60.0))

    def joined(lam: float) -> float:
        k = np.sqrt(lam)
        return float(2.0 * np.sin(0.31 * k) * np.cos(1.38 * k) + np.cos(0.31 * k) * np.sin(1.38 * k))

    exact = [brentq(joined, a, b, xtol=1e-13) for a, b in ((2, 4), (11, 14), (30, 33), (56, 60))]
    points = [p for p in line.points if p.type == "BP"]
    assert len(points) == len(exact)
    for point, lam in zip(points, exact, strict=True):
        assert point.error < 1e-8
        assert abs(point.values["lam"] - lam) <= point.error + 1e-12


@pytest.mark.parametrize("unit", [1.0, 1e9])
def test_test_of_branch_points_has_its_slope_whatever_the_null_vector_and_the_units(unit):
    """One jump of the conditions alone was all but normal to it at x = 0.3: a note of others that lie close by."""
    model = Model(
        "layered", kind="bvp", time={"name": "x", "from": 0, "to": 1}, states={"u": 0, "v": 0, "y": "x"},
        parameters={"lam": 1}, conditions=["u(start) = 0", "u(end) = 0", "y(start) = 0"],
        equations={"u": "v", "v": f"-lam*(4 if x > 0.3 else 1)*(u - u^3/{unit}^2)", "y": f"cos(u/{unit})"},
    )  # fmt: skip
    line = contin.continuation(contin.boundary_problem(model), "lam", (1, 60))
    assert [p.label for p in line.points] == ["BP1", "BP2", "BP3", "BP4"]
    assert not line.notes


def test_jump_at_a_place_that_moves_with_the_solution_is_a_note_and_makes_no_label():
    """u'' = -lam H(u - 1): lam = 1 / (a (1/2 - a)), u = 1 at x = a, which turns at lam = 16."""
    lam = 30.0
    a = 0.25 - np.sqrt(1.0 / 16.0 - 1.0 / lam)
    top = 1.0 + lam * (0.5 - a) ** 2 / 2.0
    model = Model(
        "free-boundary", kind="bvp", time={"name": "x", "from": 0, "to": 1}, states={"u": 0, "v": 0},
        parameters={"lam": lam}, conditions=["u(start) = 0", "u(end) = 0"],
        equations={"u": "v", "v": "-lam*heaviside(u - 1)"},
    )  # fmt: skip
    start = {"u": f"4*x*(1 - x)*{top}", "v": f"4*(1 - 2*x)*{top}"}
    line = contin.continuation(contin.boundary_problem(model, start), "lam", (29.0, 33.0))
    assert not line.points
    assert any("the equations jump where u - 1 = 0" in str(note) for note in line.notes)


def test_nodes_move_to_places_and_number_of_intervals_is_kept_where_it_is_fixed():
    even = np.full(10, 0.1)
    at = np.array([0.02, 0.31, 0.33])
    for fixed in (True, False):
        h = laid(even, at, fixed)
        nodes = np.concatenate([[0.0], np.cumsum(h)])
        assert np.all(h > 0.0)
        assert all(np.min(np.abs(nodes - s)) < 1e-14 for s in at)
        assert len(h) == 10 or not fixed
    assert laid(even, np.array([0.3]), fixed=True) is even
