"""Large systems solved with factors of earlier points: the same numbers as with factors of every point, few solves."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contin
from contin.linalg.factor import Factoriser
from contin.linalg.krylov import Accuracy, gmres
from contin.problems.sparse import jacobian as source
from contin.problems.sparse import large_equilibrium
from contin.problems.sparse.old_factors import WORTH, OldFactors


def plate(n, preconditioner=None):
    """lap u + lam exp(u) = 0 on the unit square, u = 0 at its boundary, n x n inner points."""
    line = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1])
    laplace = ((sp.kron(sp.eye(n), line) + sp.kron(line, sp.eye(n))) * (n + 1) ** 2).tocsc()
    return contin.FunctionProblem(
        lambda u, p: laplace @ u + p["lam"] * np.exp(u), np.zeros(n * n), {"lam": 0.0},
        lambda u, p: (laplace + sp.diags(p["lam"] * np.exp(u))).tocsc(), record=lambda u, p: {"top": u.max()},
        preconditioner=preconditioner,
    )  # fmt: skip


def followed(n, always_factored, monkeypatch):
    monkeypatch.setattr(source, "ALWAYS_FACTORED", always_factored)
    monkeypatch.setattr(large_equilibrium, "LONG_STRIDE", large_equilibrium.STRIDE)  # steps alike
    return contin.continuation(plate(n), "lam", (0, 10), settings={"steps": 16})


@pytest.mark.seldom
def test_old_factors_give_the_numbers_of_new_ones_with_few_solves(monkeypatch):
    old, new = (followed(60, limit, monkeypatch) for limit in (100, 100_000))
    a, b = old["LP1"], new["LP1"]
    assert abs(a.values["lam"] - b.values["lam"]) <= a.error + b.error + 1e-13
    assert a.values["top"] == pytest.approx(b.values["top"], abs=1e-7)  # moves as the root of lam
    for name, value in b.normal_form.items():
        if isinstance(value, float):
            assert a.normal_form[name] == pytest.approx(value, rel=1e-6)
    np.testing.assert_allclose(old.columns["lam"], new.columns["lam"], atol=1e-3)  # the same steps
    assert old.effort["factorisations"] <= 3 < new.effort["factorisations"]
    assert old.effort["applications"] <= 370  # measured 339; 634 where all is solved to the same residual


@pytest.mark.parametrize("stiff", [1.0, 1e8])
def test_an_accuracy_of_solutions_is_met_whatever_the_units_of_the_equations(stiff):
    generator = np.random.default_rng(8)
    n = 80
    units = stiff ** generator.uniform(-0.5, 0.5, n)
    matrix = units[:, None] * (np.diag(np.linspace(1.0, 1e4, n)) + generator.normal(size=(n, n)))
    near = matrix * (1.0 + 0.1 * generator.normal(size=(n, n)) / n)
    inverse = np.linalg.inv(near)
    for wanted in (1e-2, 1e-5, 1e-8):
        exact = generator.normal(size=n)
        accuracy = Accuracy(lambda x: float(np.linalg.norm(x)), lambda x, w=wanted: w * float(np.linalg.norm(x)))
        x, used, _ = gmres(lambda v: matrix @ v, lambda v: inverse @ v, matrix @ exact, 1e-14, accuracy=accuracy)
        assert np.linalg.norm(x - exact) <= 2.0 * wanted * np.linalg.norm(exact)
        _, all_of_them, _ = gmres(lambda v: matrix @ v, lambda v: inverse @ v, matrix @ exact, 1e-14)
        assert used < all_of_them


@pytest.mark.parametrize("unit", [1e-200, 1.0, 1e200])
def test_factors_in_single_precision_serve_matrices_of_any_unit_and_refuse_what_they_cannot_hold(unit):
    n = 400
    line = sp.diags([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], [-1, 0, 1])
    matrix = (unit * (line + sp.diags(0.01 * np.ones(n)))).tocsc()
    right = unit * np.random.default_rng(1).normal(size=n)
    factors = Factoriser().rough(matrix)
    for transposed in (False, True):
        x = factors.solve_transposed(right) if transposed else factors.solve(right)
        assert np.linalg.norm((matrix @ x - right) / unit) <= 1e-3 * np.linalg.norm(right / unit)
    hard = (matrix @ sp.diags(np.logspace(0.0, -44.0, n))).tocsc()
    assert Factoriser().rough(hard) is None


def test_what_single_precision_cannot_hold_is_followed_with_double(monkeypatch):
    """Both ways give the same points and the same fold."""
    single = followed(40, 100, monkeypatch)
    monkeypatch.setattr(Factoriser, "rough", lambda self, matrix: None)
    double = followed(40, 100, monkeypatch)
    a, b = single["LP1"], double["LP1"]
    assert abs(a.values["lam"] - b.values["lam"]) <= a.error + b.error + 1e-13
    assert a.normal_form["a"] == pytest.approx(b.normal_form["a"], rel=1e-9)
    np.testing.assert_allclose(single.columns["lam"], double.columns["lam"], atol=1e-3)


def test_new_factors_are_made_where_they_pay():
    """GMRES iterations a point 1, 2, 3, ...: new factors cost `WORTH`, and come before the mean grows with them."""
    n = 50
    matrix = sp.identity(n, format="csc") * 2.0
    made = OldFactors(Factoriser())
    intervals, last = [], 0
    for k in range(200):
        operator = made.at(matrix, np.zeros(n), np.array([float(k + 1)]))
        if operator.fresh:
            intervals.append(k - last)
            last = k
        operator.used = k - last
    best = np.sqrt(2.0 * WORTH)  # the least of (WORTH + k^2/2) / k
    assert len(intervals) > 3
    assert all(abs(i - best) <= 2.0 for i in intervals[1:])


def test_eigenvalues_are_followed_with_a_preconditioner_that_leaves_a_third_of_an_error():
    n = 60
    inverse = splu((plate(n).jacobian(np.zeros(n * n), {"lam": 0.0})).tocsc())
    uneven = np.random.default_rng(3).uniform(0.5, 1.0, n * n)
    weak = plate(n, lambda u, p: lambda r: inverse.solve(uneven * r))
    lines = [contin.continuation(p, "lam", (0, 10), settings={"stop_at": ("LP",)}) for p in (weak, plate(n))]
    a, b = (line["LP1"] for line in lines)
    assert abs(a.values["lam"] - b.values["lam"]) <= a.error + b.error + 1e-13
    seconds = [np.sort(np.real(line["LP1"].eigenvalues))[-2] for line in lines]
    assert seconds[0] == pytest.approx(seconds[1], rel=1e-3)
    assert lines[0].effort["applications"] <= 490  # measured 444; several times as many without


@pytest.mark.parametrize("other", [0.0, 1e9])
def test_factors_are_near_by_each_unknown_in_its_own_unit(other):
    """A large parameter that stays says nothing of how far the states have moved."""
    matrix = sp.identity(3, format="csc")
    made, u = OldFactors(Factoriser()), np.array([1.0, -2.0, 0.5])
    made.at(matrix, u, np.array([0.3, other]))
    assert made.at(matrix, u * (1.0 + 1e-4), np.array([0.3, other])).near
    assert not made.at(matrix, u * 1.01, np.array([0.3, other])).near
    assert not made.at(matrix, u, np.array([0.31, other])).near


def test_a_preconditioner_that_is_exact_where_it_was_made_is_known_by_later_points():
    """Poisson's solver for Bratu's problem, begun at lam = 0: its rate is learnt where it is not exact any more."""
    n = 1500
    laplace = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1], format="csc") * (n + 1) ** 2
    factors = splu(laplace)
    line = contin.FunctionProblem(
        lambda u, p: laplace @ u + p["lam"] * np.exp(u), np.zeros(n), {"lam": 0.0},
        lambda u, p: (laplace + sp.diags(p["lam"] * np.exp(u))).tocsc(), preconditioner=lambda u, p: factors.solve,
    )  # fmt: skip
    branch = contin.continuation(line, "lam", (0.0, 4.0), settings={"stop_at": ["LP"]})
    fold = branch["LP1"]
    assert abs(fold.values["lam"] - 3.513830719 + 1.25 * 0.98 / (n + 1) ** 2) < 1e-6
    assert branch.effort["applications"] <= 420  # measured 351; 1,676 where eigenvalues are looked for anew each time


@pytest.mark.seldom
def test_a_double_branch_point_of_a_symmetric_system_is_none_of_hopf(monkeypatch):
    """Mittelmann's problem on a square: constant u = lam exp(u) branches where 10 (u - 1) is an eigenvalue of -lap.

    Of two equal eigenvalues, Ritz values of a matrix that is not taken as symmetric are a complex pair to rounding.
    """
    n = 50
    monkeypatch.setattr(source, "ALWAYS_FACTORED", 100)
    line = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1]).tolil()
    line[0, 0] = line[-1, -1] = -1.0
    laplace = ((sp.kron(sp.eye(n), line) + sp.kron(line, sp.eye(n))) * n**2).tocsc()
    square = contin.FunctionProblem(
        lambda u, p: laplace @ u - 10.0 * (u - p["lam"] * np.exp(u)), np.full(n * n, 1.9), {"lam": 1.9 * np.exp(-1.9)},
        lambda u, p: (laplace + sp.diags(10.0 * p["lam"] * np.exp(u) - 10.0)).tocsc(),
    )  # fmt: skip
    branch = contin.continuation(square, "lam", (0.26, 0.285), settings={"stop_at": "BP"}, direction="down")
    u = 1.0 + 0.1 * 2.0 * (1.0 - np.cos(np.pi / n)) * n**2
    point = branch["BP1"]
    assert abs(point.values["lam"] - u * np.exp(-u)) <= point.error + 1e-12
    assert point.normal_form["kernel"] == 2
    assert branch.effort["factorisations"] <= 12
