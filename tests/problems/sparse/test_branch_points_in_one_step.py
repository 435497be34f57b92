"""The test for branch points of sparse systems vanishes where their matrix is singular: it is more than a sign.

Two crossings within one step leave signs and counts as they were; a low test tells them. A branch that turns where it
crosses another one, as at a pitchfork, changes the determinant's sign and no count.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse

import contin
from contin import api

FIRST = 0.513


def planted(n, values, slopes, start, p=0.0, rate=1.0):
    """y_k' = rate (L_k(p) y_k - y_k^3) in turned coordinates; values, slopes: p -> the first of L, and of dL/dp."""
    turn = np.linalg.qr(np.random.default_rng(n).normal(size=(n, n)))[0]

    def rates_of(p):
        return np.concatenate([values(p), -1.0 - np.arange(n - len(values(p)))])

    def function(u, q):
        y = turn.T @ u
        return rate * turn @ (rates_of(q["p"]) * y - y**3)

    def jacobian(u, q):
        return rate * scipy.sparse.csc_matrix(turn @ np.diag(rates_of(q["p"]) - 3.0 * (turn.T @ u) ** 2) @ turn.T)

    def by_parameter(u, q, name):
        y = turn.T @ u
        return (
            rate * turn @ np.concatenate([slopes(q["p"]) * y[: len(values(q["p"]))], np.zeros(n - len(values(q["p"])))])
        )

    u = turn @ np.pad(np.array(start, dtype=float), (0, n - len(start)))
    return contin.FunctionProblem(function, u, {"p": p}, jacobian, parameter_jacobian=by_parameter)


@pytest.mark.parametrize("gap", [0.05, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("n", [6, 40])
@pytest.mark.parametrize("senses", ["one value, twice", "two values, in opposite senses"])
def test_two_crossings_within_a_step_are_both_found(senses, n, gap):
    if senses == "one value, twice":
        values = lambda p: np.array([-10.0 * (p - FIRST) * (p - FIRST - gap)])  # noqa: E731
        slopes = lambda p: np.array([-10.0 * (2.0 * p - 2.0 * FIRST - gap)])  # noqa: E731
    else:
        values = lambda p: np.array([p - FIRST, FIRST + gap - p])  # noqa: E731
        slopes = lambda p: np.array([1.0, -1.0])  # noqa: E731
    line = api.continuation(api.equilibrium(planted(n, values, slopes, [])), "p", (0.0, 1.0))
    assert [point.type for point in line.points] == ["BP", "BP"]
    for point, place in zip(line.points, (FIRST, FIRST + gap), strict=True):
        assert abs(point.values["p"] - place) <= point.error + 1e-15


@pytest.mark.parametrize("begin", [0.1, 0.17, 0.3, 0.5, 0.9])
@pytest.mark.parametrize(
    ("n", "rate"),
    [(6, 1e-12), (6, 1.0), (6, 1e9), (40, 1.0), *(pytest.param(40, r, marks=pytest.mark.long) for r in (1e-12, 1e9))],
)
def test_a_pitchfork_is_found_from_the_branch_that_turns_there(n, begin, rate):
    """From y = sqrt(p - FIRST) through the pitchfork to -sqrt(p - FIRST)."""
    p = FIRST + begin
    problem = planted(n, lambda p: np.array([p - FIRST]), lambda p: np.array([1.0]), [np.sqrt(begin)], p, rate)
    side = api.continuation(api.equilibrium(problem), "p", (0.0, 1.6), direction="down")
    (point,) = side.points
    assert (point.type, point.normal_form["kind"]) == ("BP", "pitchfork")
    assert abs(point.values["p"] - FIRST) <= point.error + 1e-15
    assert not side.notes
