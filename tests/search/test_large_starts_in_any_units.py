"""Large systems whose states have units of their own."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse

import contin


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e6, 1e12])
def test_small_states_beside_large_ones_are_solved_for_as_well(unit):
    """x_i = unit p, and y_i + y_i^3 = 2 with y_i = 1, far from the guess 5 when the linear equations are solved."""
    n, calls = 60, []
    turn = scipy.sparse.csc_matrix(np.roll(np.eye(n), 1, axis=0))

    def rates(u, p):
        x, y = u[:n], u[n:]
        return np.concatenate([unit * p["p"] - x + 0.1 * (turn @ x - x), 2.0 - y - y**3])

    def jacobian(u, p):
        calls.append(1)
        lower = scipy.sparse.diags(-1.0 - 3.0 * u[n:] ** 2)
        return scipy.sparse.bmat([[0.1 * turn - 1.1 * scipy.sparse.identity(n), None], [None, lower]]).tocsc()

    guess = np.concatenate([np.full(n, 0.9 * unit), np.full(n, 5.0)])
    found = contin.equilibrium(contin.FunctionProblem(rates, guess, {"p": 1.0}, jacobian))
    np.testing.assert_allclose(found.u[:n], unit, rtol=1e-12)
    np.testing.assert_allclose(found.u[n:], 1.0, rtol=1e-12)
    assert len(calls) <= 15  # measured 12


@pytest.mark.parametrize("unit", [1.0, 1e3, pytest.param(1e6, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_with_typical_sizes_folds_do_not_depend_on_units_and_without_them_the_message_names_them(unit):
    """x_i = unit beside y - y^3/3 + a = 0, which folds at a = +-2/3."""
    n = 61
    turn = scipy.sparse.csc_matrix(np.roll(np.eye(n), 1, axis=0)) - scipy.sparse.identity(n)

    def rates(u, p):
        return np.append(unit - u[:n] + 0.1 * (turn @ u[:n]), p["a"] + u[n] - u[n] ** 3 / 3.0)

    def jacobian(u, p):
        one = scipy.sparse.csc_matrix([[1.0 - u[n] ** 2]])
        return scipy.sparse.bmat([[0.1 * turn - scipy.sparse.identity(n), None], [None, one]]).tocsc()

    def followed(typical):
        start = np.append(np.full(n, unit), -2.1)
        problem = contin.FunctionProblem(rates, start, {"a": -1.0}, jacobian, typical=typical)
        return contin.continuation(contin.equilibrium(problem), "a", (-1.0, 1.0))

    line = followed(np.append(np.full(n, unit), 2.0))
    assert [point.type for point in line.points] == ["LP", "LP"]
    assert [point.values["a"] for point in line.points] == pytest.approx([2.0 / 3.0, -2.0 / 3.0], abs=1e-9)
    if unit > 1.0:
        assert any("`typical` sizes" in end.text for end in followed(1.0).ends)
