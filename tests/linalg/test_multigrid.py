"""Cycles of multigrid: symmetric inverses whose count of iterations does not grow, of diffusions of either sign."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.linalg.coloured import Places, placed
from contin.linalg.krylov import gmres
from contin.linalg.packed_rows import Packed
from tests.problems.sparse.test_old_factors import plate

pyamg = pytest.importorskip("pyamg")


def laplace(n, unit=1.0):
    line = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1])
    return (unit * (sp.kron(sp.eye(n), line) + sp.kron(line, sp.eye(n)))).tocsr()


@pytest.mark.parametrize("unit", [1e-200, 1.0, -1e200])
def test_a_cycle_is_linear_symmetric_and_takes_most_of_an_error_away(unit):
    matrix = laplace(30, unit)
    cycle, generator = contin.multigrid(matrix), np.random.default_rng(1)
    a, b = generator.normal(size=(2, 900))
    both = cycle(a) + 2.0 * cycle(b)
    assert np.abs(cycle(a + 2.0 * b) - both).max() <= 1e-12 * np.abs(both).max()
    assert a @ cycle(b) == pytest.approx(b @ cycle(a), rel=1e-7)
    x = np.zeros(900)
    for _ in range(6):
        x = x + cycle(matrix @ (a - x))
    assert np.linalg.norm(a - x) < 1e-3 * np.linalg.norm(a)


@pytest.mark.parametrize("make", ["ruge_stuben_solver", "smoothed_aggregation_solver"])
def test_iterations_hardly_grow_with_the_number_of_unknowns(make):
    counts = []
    for n in (20, 80):
        matrix = laplace(n)
        right = np.random.default_rng(2).normal(size=n * n)
        x, used, _ = gmres(lambda v, a=matrix: a @ v, contin.multigrid(matrix, getattr(pyamg, make)), right, 1e-10)
        assert np.linalg.norm(matrix @ x - right) <= 1e-9 * np.linalg.norm(right)
        counts.append(used)
    assert counts[1] <= counts[0] + 5 <= 22


@pytest.mark.parametrize("of_states", [0, 6])
@pytest.mark.parametrize("of_residuals", [0, 6])
def test_packed_rows_have_nine_digits_in_any_units_of_states_and_residuals(of_states, of_residuals):
    n = 144
    unit = 10.0 ** np.where(np.arange(n) % 3 == 0, 1.0, -1.0)
    matrix = (sp.diags(unit**of_residuals) @ laplace(12) @ sp.diags(unit**of_states)).tocsr()
    place = Places.of(matrix, sp.eye(n, format="csr")[:, ::2])
    scaled = placed(matrix, place, place.rows, place, place.columns)
    np.testing.assert_array_equal(scaled.diagonal(), 1.0)
    if of_states == of_residuals:
        assert abs(scaled - scaled.T).max() == 0.0
    x = np.random.default_rng(3).uniform(0.5, 1.0, n)
    found = Packed.of(scaled).times(x, np.empty(n))
    assert np.all(np.abs(found - scaled @ x) <= 1e-8 * (abs(scaled) @ x))


def test_empty_rows_of_packed_matrices_are_zero_and_longer_results_keep_their_end():
    matrix = sp.csr_matrix(np.array([[0.0, 2.0], [0.0, 0.0], [-1.0, 3.0], [0.0, 0.0]]))
    x = np.array([1.0, 10.0])
    np.testing.assert_allclose(Packed.of(matrix).times(x, np.full(5, 7.0)), [20.0, 0.0, 29.0, 0.0, 7.0], rtol=1e-9)
    np.testing.assert_allclose(Packed.of(matrix).times(x, np.ones(4), add=True), [21.0, 1.0, 30.0, 1.0], rtol=1e-9)


def test_rows_of_one_colour_do_not_depend_on_each_other():
    matrix = sp.random(300, 300, 0.02, random_state=1).tocsr() + sp.eye(300, format="csr")
    place = Places.of(matrix, sp.eye(300, format="csr")[:, ::2])
    coloured = abs(placed(matrix, place, place.rows, place, place.columns))
    for first, last in pairwise(place.colours):
        assert coloured[first:last, first:last].nnz == last - first
    assert sorted(place.order) == list(range(300))


def test_bratus_fold_is_that_of_factors_with_one_set_of_levels():
    start = contin.continuation(plate(24), "lam", (0, 10), settings={"steps": 16, "stop_at": "LP"})["LP1"]
    n = 24
    made = []

    def precondition(u, p):
        made.append(p["lam"])
        return contin.multigrid(laplace(n, (n + 1) ** 2) + sp.diags(p["lam"] * np.exp(u)))

    line = contin.continuation(plate(n, precondition), "lam", (0, 10), settings={"steps": 16, "stop_at": "LP"})
    fold = line["LP1"]
    assert abs(fold.values["lam"] - start.values["lam"]) <= fold.error + start.error
    assert line.effort["factorisations"] == len(made) == 1
    assert line.effort["applications"] <= 420


def test_what_no_cycle_can_be_made_of_is_refused_in_words():
    with pytest.raises(contin.InputError, match="square matrix, not 1 x 9: as a preconditioner, write `lambda u, p"):
        contin.multigrid(np.zeros(9))  # what `preconditioner=contin.multigrid` would give it
    with pytest.raises(contin.InputError, match="positive everywhere, or negative everywhere"):
        contin.multigrid(sp.diags([1.0, -1.0, 2.0]))
    with pytest.raises(contin.InputError, match="2500 unknowns, more than 2000"):
        contin.multigrid(-laplace(50), lambda a: pyamg.ruge_stuben_solver(a, max_levels=1))
