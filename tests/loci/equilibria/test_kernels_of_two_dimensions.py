"""Algebraic curves of branch points and folds through kernels of two dimensions, of which no label tells: a note."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

import contin
from contin.errors import ContinError
from contin.model.model import Model

BOX = {"p": (-2.0, 2.0), "q": (-2.0, 2.0)}
WORDS = "the kernel of F_u has two dimensions"


def notes(equations, type_, start=0.0, kind="algebraic"):
    states = {"x": start, "y": 0.0}
    model = Model("two", kind=kind, states=states, parameters={"p": -0.9, "q": 0.3}, equations=equations)
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    curve = contin.continuation(line[f"{type_}1"].locus(("p", "q")), ("p", "q"), BOX)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    return [note for note in curve.notes if WORDS in note]


@pytest.mark.parametrize("sense", ["", "-"])
@pytest.mark.parametrize("square", ["x^2", "x^2 - 0.3*y^2", "x^3"])
def test_two_crossings_at_one_point_are_a_note(square, sense):
    """p x - x^2 = 0 and (p - q) y - y^2 = 0 along x = y = 0: p = 0 is singular, and F_u vanishes where q = 0, too."""
    (note,) = notes({"x": f"{sense}(p*x - ({square}))", "y": "(p - q)*y - y^2 + 0.2*x*y"}, "BP")
    assert float(note.split("q = ")[1].split(":")[0]) == pytest.approx(0.0, abs=0.1)


def test_a_fold_that_is_a_branch_point_too_is_a_note():
    """p + 1 = x^2 and (x - q) y = y^2: a fold at x = 0, which is a branch point where q = 0, too."""
    assert len(notes({"x": "p + 1 - x^2", "y": "(x - q)*y - y^2"}, "LP", start=0.3)) == 1


def test_where_the_kernel_has_one_dimension_there_is_no_note():
    """p x + y = x^2, y (q + 3) = x^2: F_u has the determinant p (q + 3), with no second zero in the box."""
    assert notes({"x": "p*x + y - x^2", "y": "(q + 3)*y - x^2"}, "BP") == []
    assert notes({"x": "p*x - x^2", "y": "(p - q)*y - y^2"}, "BP", kind="flow") == []


@pytest.mark.parametrize("alpha", [0.556, 0.84, 1.0])
def test_branch_points_with_a_double_zero_all_along_are_followed_or_said_not_to_be(alpha):
    """Watt's governor with its arms down: x = 0, load 1, and any speed is a state of rest."""
    start = contin.equilibrium(contin.load("classics/watt-governor"), parameters={"alpha": alpha})
    point = contin.continuation(start, "beta", (0.32, 1.36))["BP1"]
    with suppress(ContinError):  # in words; the equations of the curve are singular
        curve = contin.continuation(point.locus(), ["alpha", "beta"], {"alpha": (0.4, 1.7), "beta": (0.32, 1.36)})
        assert np.allclose(curve.columns["beta"], 1.0, rtol=0.0, atol=1e-9)
