"""Solutions that are not smooth, whose errors no derivative of theirs tells."""

from __future__ import annotations

import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model

NEAREST = 1e-10  # to the singular end


def root(settings=None):
    """u' = p/(2 sqrt x) + w, w' = 0, u = 0 at 1e-10, u = 1 at 1: w (1 - 1e-10) = 1 - p (1 - 1e-5)."""
    model = Model(
        "root", kind="bvp", time={"name": "x", "from": NEAREST, "to": 1}, states={"u": 0, "w": 0},
        parameters={"p": 0.5}, equations={"u": "p/(2*sqrt(x)) + w", "w": "0"},
        conditions=["u(start) = 0", "u(end) = 1"],
    )  # fmt: skip
    guess = boundary_guess(model, {"u": "x", "w": "0.5"})
    return contin.continuation(guess, "p", (0.5, 2.0), values={"w.start": [0.0]}, settings=settings)


def exact(p):
    return (1.0 - p * (1.0 - NEAREST**0.5)) / (1.0 - NEAREST)


def test_a_root_at_an_end_is_resolved_and_its_user_value_right_to_its_error():
    """The mesh left w 3e-4 off, and said 1e-7."""
    branch = root()
    assert branch.columns["w.start"] == pytest.approx(exact(branch.columns["p"]), abs=3e-6)
    assert abs(branch["UZ1"].values["p"] - 1.0 / (1.0 - NEAREST**0.5)) <= max(branch["UZ1"].error, 1e-12)
    assert branch["UZ1"].error < 1e-5
    assert not branch.notes


def test_where_the_mesh_is_given_it_is_a_note():
    branch = root({"intervals": 20})
    assert any("met between the points of the mesh only to" in note for note in branch.notes)


def test_a_corner_is_resolved():
    """u' = |x - p|, u(0) = 0: u(1) = (p^2 + (1 - p)^2)/2."""
    model = Model(
        "corner", kind="bvp", time={"name": "x", "from": 0, "to": 1}, states={"u": 0}, parameters={"p": 0.3},
        equations={"u": "abs(x - p)"}, conditions=["u(start) = 0"],
    )  # fmt: skip
    branch = contin.continuation(boundary_guess(model), "p", (0.3, 0.7), settings={"max_step": 0.1})
    p = branch.columns["p"]
    assert branch.columns["u.end"] == pytest.approx(0.5 * (p * p + (1.0 - p) * (1.0 - p)), abs=1e-5)
