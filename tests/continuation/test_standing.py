"""Families of orbits that all exist at one parameter value end; canard explosions, with other multipliers, do not."""

from types import SimpleNamespace

import numpy as np
import pytest

from contin.continuation.ends import standing
from contin.continuation.ends.standing import ROWS, until_standing
from contin.continuation.segment import Segment


def segments(p, multiplier):
    for value in p:
        z = np.array([[0.0, value]])
        yield Segment(z, z, np.zeros(1, np.int64), np.array([[1.0, multiplier]], complex), np.array([1.0, 2.0]))


def followed(p, multiplier=1.0, kind="orbit", may_stand=False):
    problem = SimpleNamespace(kind=kind, may_stand=may_stand, parameters=("p",))
    arm = SimpleNamespace(problem=problem, end=None)
    arm.is_over = lambda: arm.end is not None
    return len(list(until_standing(segments(p, multiplier), arm))), arm.end


STANDING = 0.5 + 1e-12 * np.arange(2 * ROWS)


def test_a_continuum_ends():
    rows, end = followed(STANDING)
    assert rows == ROWS
    assert end.reason == "degenerate"
    assert "all exist at p = 0.5: they are a continuum" in end.text


@pytest.mark.parametrize(
    "options",
    [{"multiplier": 0.3}, {"kind": "equilibrium"}, {"may_stand": True}],
    ids=["canard", "equilibria", "first integral"],
)
def test_other_branches_go_on(options):
    assert followed(STANDING, **options) == (2 * ROWS, None)


def in_two(moves, way=0.02):
    """A curve in two parameters, the states of which go `way` a row."""
    problem = SimpleNamespace(kind="locus", parameters=("p", "q"))
    arm = SimpleNamespace(problem=problem, end=None)
    arm.is_over = lambda: arm.end is not None
    rows = np.array([[way * k, 1.0 - moves * k, 0.5 + moves * k] for k in range(200)])
    found = [Segment(z[None], z[None], np.zeros(1, np.int64), np.ones((1, 1), complex), np.ones(3)) for z in rows]
    return len(list(until_standing(found, arm))), arm.end


def test_a_curve_both_of_whose_parameters_stand_still_ends_and_says_where(monkeypatch):
    monkeypatch.setattr(standing, "in_two_parameters", lambda problem: True)
    rows, end = in_two(1e-17)
    assert rows == 51  # a length of 1
    assert end.reason == "degenerate"
    assert "p = 0.5, q = 1: solutions are a continuum" in end.text
    assert in_two(1e-9) == (200, None)


def test_a_parameter_that_moves_goes_on():
    assert followed(0.5 + 1e-6 * np.arange(2 * ROWS)) == (2 * ROWS, None)
