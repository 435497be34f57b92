"""Types of equilibria of the plane, decided against errors: linear flows, weak foci, double roots, stiff nodes."""

import numpy as np
import pytest

import contin
from contin.plane.field import planar_field
from contin.plane.rest import rests


def at_rest(x, y, window=((-1, 1), (-1, 1))):
    model = contin.Model(name="m", states={"x": 0.5, "y": 0.3}, parameters={"a": 1.0}, equations={"x": x, "y": y})
    return rests(planar_field(model, "x", "y"), np.array(window, dtype=float))


@pytest.mark.parametrize(
    ("matrix", "kind"),
    [
        ((-1, 0, 0, -3), "stable node"), ((1, 5, 0, 3), "unstable node"), ((-1, 2, -2, -1), "stable focus"),
        ((1, 2, -2, 1), "unstable focus"), ((1, 0, 0, -1), "saddle"), ((0, 1, -1, 0), "centre of the linearisation"),
        ((-1, 1, 0, -1), "stable degenerate node"), ((-1e-5, 0, 0, -1e5), "stable node"),
        ((-1e-11, 1, -1, -1e-11), "stable focus"), ((1e-7, 0, 0, -1e7), "saddle"),
    ],
)  # fmt: skip
def test_linear_flows(matrix, kind):
    a, b, c, d = (repr(float(v)) for v in matrix)
    (one,), _ = at_rest(f"{a}*x + {b}*y", f"{c}*x + {d}*y")
    assert one.type == kind


def test_a_double_root_is_a_saddle_node_though_its_place_is_known_to_half_the_digits():
    (one,), notes = at_rest("1 - 2*x + x^2", "-y", ((0, 3), (-1, 1)))
    assert one.type == "saddle-node"
    assert "w' = 1 w^2" in notes[0]


def test_two_roots_that_are_close_are_a_node_and_a_saddle():
    both, notes = at_rest("x^2 - 1e-8", "-y", ((-0.01, 0.011), (-1, 1)))  # x = -+1e-4
    assert [one.type for one in both] == ["stable node", "saddle"]
    assert not notes


def test_a_weak_focus_is_told_from_a_centre_by_its_lyapunov_coefficient():
    (one,), notes = at_rest("-y - x*(x^2 + y^2)", "x - y*(x^2 + y^2)")
    assert (one.type, one.stability) == ("weak stable focus", "stable")
    assert "l1 = -2" in notes[0]


def test_one_of_a_line_of_equilibria_is_degenerate():
    (one,), notes = at_rest("-x", "x*y", ((-2, 2), (-2, 2)))
    assert one.type == "degenerate equilibrium"
    assert "line" in notes[0]
