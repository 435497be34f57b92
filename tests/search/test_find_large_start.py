"""`start: auto` of large flows: with sparse factors, and with as few as a method for stiff flows needs."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse

import contin
from contin.errors import NoSolutionError
from contin.problems.sparse.jacobian import JacobianSource
from contin.search.large_equilibrium import LargeEquilibrium
from contin.search.relaxed_large import relax_large

SCHNAKENBERG = """
contin: 1
name: schnakenberg
kind: pde
fields: {u: 1.5 + cos(pi*x/20), v: 0.5}
domain: {x: {from: 0, to: 20, points: 301}}
parameters: {a: 0.3, b: 1.0, D: 20}
equations:
  u: dxx(u) + a - u + u^2*v
  v: D*dxx(v) + b - u^2*v
boundary: {all: [dx(u) = 0, dx(v) = 0]}
"""


def chafee_infante(n, lam, start):
    """u'' + lam u - u^3 on (0, pi), u = 0 at the ends; columns: the values at the n points inside."""
    h = np.pi / (n + 1)
    second = scipy.sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n, n), format="csc") / h**2
    x = h * np.arange(1, n + 1)
    calls = []

    def jacobian(u, p):
        calls.append(1)
        return (second + scipy.sparse.diags(p["lam"] - 3.0 * u**2)).tocsc()

    def rates(u, p):
        return second @ u + p["lam"] * u - u**3

    return contin.FunctionProblem(rates, start(x), {"lam": lam}, jacobian), calls


def test_a_patterned_state_relaxes_to_the_homogeneous_one(tmp_path):
    """Stable there: u = a + b, v = b/(a + b)^2."""
    file = tmp_path / "schnakenberg.yaml"
    file.write_text(SCHNAKENBERG)
    found = contin.find_start(contin.load(file))
    u, v = found.solution.u[::2], found.solution.u[1::2]
    assert found.how == "rest"
    assert u == pytest.approx(1.3, rel=1e-9)
    assert v == pytest.approx(1.0 / 1.3**2, rel=1e-9)


def test_off_an_unstable_state_the_trajectory_is_pushed():
    """Two humps are unstable at lam = 6, and their symmetry keeps the trajectory on its way to them."""
    problem, calls = chafee_infante(501, 6.0, lambda x: 0.7 * np.sin(2.0 * x))
    found = contin.find_start(problem)
    assert found.how == "rest"
    assert "unstable" not in found.words
    assert np.all(found.solution.u > 0.0) or np.all(found.solution.u < 0.0)
    assert len(calls) < 400


def test_algebraic_equations_hold_while_the_others_relax():
    """x_k' = a - x_k - z_k with 0 = z_k - x_k^2: x = (sqrt(1 + 4 a) - 1)/2. As u' = F it would run away."""
    n = 40

    def rates(u, p):
        x, z = u[:n], u[n:]
        return np.concatenate([p["a"] - x - z + 0.1 * (np.roll(x, 1) - x), z - x**2])

    def jacobian(u, p):
        turn = scipy.sparse.csc_matrix(np.roll(np.eye(n), 1, axis=0))
        one = scipy.sparse.identity(n)
        return scipy.sparse.bmat([[-1.1 * one + 0.1 * turn, -one], [scipy.sparse.diags(-2.0 * u[:n]), one]]).tocsc()

    mass = np.concatenate([np.ones(n), np.zeros(n)])
    start = np.concatenate([np.linspace(1.0, 4.0, n), np.linspace(1.0, 16.0, n)])
    problem = contin.FunctionProblem(rates, start, {"a": 1.0}, jacobian, mass=mass)
    found = contin.find_start(problem)
    assert found.how == "rest"
    assert found.solution.u[:n] == pytest.approx((np.sqrt(5.0) - 1.0) / 2.0, rel=1e-9)


def bratu_without_a_solution(n=60):
    """u'' + 10 e^u on (0, 1): beyond the fold at 3.514 there is no solution, and everything explodes."""
    second = scipy.sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n, n), format="csc") * (n + 1.0) ** 2
    return contin.FunctionProblem(
        lambda u, p: second @ u + p["lam"] * np.exp(u), np.zeros(n), {"lam": 10.0},
        lambda u, p: (second + scipy.sparse.diags(p["lam"] * np.exp(u))).tocsc(),
    )  # fmt: skip


def test_where_nothing_rests_it_is_said():
    with pytest.raises(NoSolutionError, match=r"escapes|cannot be followed"):
        contin.find_start(bratu_without_a_solution())


def test_a_start_that_newton_does_not_solve_names_the_way_out():
    with pytest.raises(NoSolutionError, match=r"start: auto"):
        contin.api.equilibrium(bratu_without_a_solution())


@pytest.mark.parametrize("seed", range(4))
def test_a_neutral_rest_is_not_unstable_by_rounding(seed):
    """Heat on a ring with random conductances and capacities c: sum c u is conserved, an eigenvalue is 0."""
    generator, n = np.random.default_rng(seed), 80
    turn = scipy.sparse.csc_matrix(np.roll(np.eye(n), 1, axis=0)) - scipy.sparse.identity(n)
    c = np.exp(generator.normal(size=n))
    matrix = scipy.sparse.diags(-1.0 / c) @ turn.T @ scipy.sparse.diags(generator.uniform(0.5, 2.0, n)) @ turn
    start = 2.0 + np.sin(2.0 * np.pi * np.arange(n) / n)
    problem = contin.FunctionProblem(
        lambda u, p: p["rate"] * (matrix @ u), start, {"rate": 1e3}, lambda u, p: (p["rate"] * matrix).tocsc()
    )
    system, p = problem.system(), np.array([1e3])
    end = relax_large(system, start, p, lambda u: LargeEquilibrium(system, u, p, JacobianSource(system)))
    assert (end.outcome, end.stable) == ("rest", True)
    assert end.u == pytest.approx(c @ start / c.sum(), rel=1e-4)
