"""Deflated continuation: disconnected branches are found, counted and followed."""

import numpy as np
import pytest

import contin
from contin.search.deflated_newton import beside
from contin.search.index_sums import index_between, words


def test_deflation_finds_the_roots_of_a_polynomial_one_after_the_other():
    def correction(u):
        return -np.array([np.prod(u - ROOTS) / sum(np.prod(np.delete(u - ROOTS, k)) for k in range(3))])

    found = []
    for _ in range(4):
        u = beside(correction, np.array([0.7]), found, 1.0)
        if u is not None:
            found.append(u)
    np.testing.assert_allclose(np.sort(np.ravel(found)), ROOTS, atol=1e-9)


ROOTS = np.array([-1.5, 0.2, 2.0])


@pytest.mark.seldom
def test_all_branches_of_chafee_and_infante_between_their_second_and_third_bifurcation():
    # u_t = u_xx + lam (u - u^3) on (0, pi), u = 0 at the ends: 2 n + 1 solutions where n^2 < lam < (n + 1)^2, and none
    # of their branches meet between lam = 5 and 8
    model = contin.load({
        "name": "chafee", "kind": "pde", "domain": {"x": {"to": np.pi, "points": 11, "method": "chebyshev"}},
        "fields": {"u": 0}, "parameters": {"lam": {"value": 5, "range": [5, 8]}},
        "equations": {"u": "dxx(u) + lam*(u - u^3)"}, "boundary": {"all": "u = 0"},
    })  # fmt: skip
    found = contin.deflated(model, "lam", samples=1)
    assert found.notes[0] == "lam = 5: 5 solutions, 4 of them by deflation there"
    assert len(found) == 5
    assert all([end.reason for end in branch.ends] == ["bound", "bound"] for branch in found)
    unstable = sorted(int(b.columns["unstable"][0]) for b in found)
    assert unstable == [0, 0, 1, 1, 2]


def test_a_model_of_formulas_and_a_limit_on_branches():
    model = contin.load({"name": "three", "states": {"x": 0}, "parameters": {"p": 1}, "equations": {"x": "x*(p-x^2)"}})
    found = contin.deflated(model, "p", (0.5, 2), samples=2)
    assert len(found) == 3
    np.testing.assert_allclose(sorted(b.columns["x"][0] ** 2 / b.columns["p"][0] for b in found), [0, 1, 1], atol=1e-9)
    limited = contin.deflated(model, "p", (0.5, 2), samples=2, most=2)
    assert "the search ended at 2 branches" in limited.notes[-1]


def test_solutions_that_are_missing_change_the_sum_of_indices_and_are_told():
    # x' = p x - x^3: one solution of index 1 where p < 0, indices 1 - 1 + 1 beyond
    model = contin.load({"name": "fork", "states": {"x": 0}, "parameters": {"p": -1}, "equations": {"x": "p*x - x^3"}})
    whole = contin.deflated(model, "p", (-1, 2), samples=[-0.5, 1.5])
    assert [note.split(", ")[0] for note in whole.notes] == ["p = -0.5: 1 solution", "p = 1.5: 3 solutions"]
    told = words("p", {-0.5: [1], 1.5: [-1, 1]})  # one half of the fork
    assert "different sums: 1 at -0.5, 0 at 1.5" in str(told)
    assert words("p", {-0.5: [1], 1.5: [1, -1, 1]}) is None
    assert words("p", {-0.5: [1], 1.5: [-1, 0]}) is None  # one index is not known
    assert [index_between(np.array([2.0, 2.0, 1.0, np.nan, np.nan]), k) for k in range(4)] == [1, 0, 0, 0]
