"""The linear algebra of large systems against dense algebra."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from contin.linalg.beside_zero import by_approximation
from contin.linalg.bordered import bordered
from contin.linalg.eigen import CONVERGED, Region, leading
from contin.linalg.factor import BandFactor, Factoriser, SuperFactor, TridiagonalFactor
from contin.linalg.krylov import gmres
from contin.linalg.linear import DirectLinear, KrylovLinear

GENERATOR = np.random.default_rng(0)


def band(n, width):
    diagonals = [GENERATOR.normal(size=n - abs(k)) for k in range(-width, width + 1)]
    return sp.diags(diagonals, range(-width, width + 1), format="csc")


def shuffled(matrix):
    order = GENERATOR.permutation(matrix.shape[0])
    return matrix[order][:, order].tocsc()


def scattered(n):
    return (sp.random(n, n, 0.03, random_state=1) + sp.diags([3.0 + GENERATOR.random(n)], [0])).tocsc()


FACTORED = {
    "tridiagonal": (band(60, 1), TridiagonalFactor), "band": (band(60, 4), BandFactor),
    "shuffled band": (shuffled(band(400, 3)), BandFactor), "scattered": (scattered(300), SuperFactor),
}  # fmt: skip


@pytest.mark.parametrize("name", FACTORED)
@pytest.mark.parametrize("shift", [0.0, 0.7j])
def test_factors_solve_transposed_too_and_give_the_sign_of_the_determinant(name, shift):
    matrix, kind = FACTORED[name]
    matrix = (matrix - shift * sp.identity(matrix.shape[0])).tocsc() if shift else matrix.copy()
    matrix.sort_indices()
    factor = Factoriser().factor(matrix)
    assert isinstance(factor, kind)
    right = GENERATOR.normal(size=matrix.shape[0])
    np.testing.assert_allclose(matrix @ factor.solve(right), right, atol=1e-9)
    np.testing.assert_allclose(matrix.T @ factor.solve_transposed(right), right, atol=1e-9)
    both = right + 1j * right[::-1]
    np.testing.assert_allclose(matrix @ factor.solve(both), both, atol=1e-9)
    if not shift:
        assert factor.sign == np.linalg.slogdet(matrix.toarray())[0]


def test_bordered_solves_are_accurate_where_the_matrix_is_singular():
    n = 40
    matrix = band(n, 1).toarray()
    values = np.linalg.eigvals(matrix)
    real = int(np.argmin(np.abs(values.imag) + 1e-3 * np.abs(values.real)))
    singular = sp.csc_matrix(sp.diags([np.zeros(n)], [0]) + sp.csc_matrix(matrix)) - values[real].real * sp.identity(n)
    singular = singular.tocsc()
    assert np.linalg.svd(singular.toarray(), compute_uv=False)[-1] < 1e-12
    columns, rows, corner = GENERATOR.normal(size=(n, 2)), GENERATOR.normal(size=(n, 2)), GENERATOR.normal(size=(2, 2))
    corner[0, 0] = 0.0
    whole = np.block([[singular.toarray(), columns], [rows.T, corner]])
    exact = GENERATOR.normal(size=n + 2)
    solver = bordered(Factoriser().factor(singular), columns, rows, corner)
    np.testing.assert_allclose(solver.solve(whole @ exact), exact, atol=1e-9)
    np.testing.assert_allclose(solver.solve_transposed(whole.T @ exact), exact, atol=1e-9)


def test_gmres_takes_as_many_steps_as_there_are_distinct_eigenvalues():
    values = np.repeat([1.0, 2.0, 5.0, 9.0], 25)
    basis, _ = np.linalg.qr(GENERATOR.normal(size=(100, 100)))
    matrix = basis @ np.diag(values) @ basis.T
    right = GENERATOR.normal(size=100)
    x, used, residual = gmres(lambda v: matrix @ v, lambda v: v, right)
    assert used == 4
    assert residual < 1e-11
    np.testing.assert_allclose(matrix @ x, right, atol=1e-9)
    shifted = matrix + 1j * np.eye(100)
    x, _, residual = gmres(lambda v: shifted @ v, lambda v: v, right.astype(complex))
    np.testing.assert_allclose(shifted @ x, right, atol=1e-9)


def test_region_holds_every_unstable_eigenvalue():
    for seed in range(5):
        matrix = sp.csc_matrix(np.random.default_rng(seed).normal(size=(30, 30)))
        right, up = Region().of(matrix)
        values = np.linalg.eigvals(matrix.toarray())
        unstable = values[values.real >= 0]
        assert np.all(unstable.real <= right + 1e-12)
        assert np.all(np.abs(unstable.imag) <= up + 1e-12)


def test_region_of_any_pattern_is_that_of_a_full_one():
    matrix = np.random.default_rng(3).normal(size=(30, 30))
    np.testing.assert_allclose(Region.of_any(sp.csc_matrix(matrix)), Region().of(sp.csc_matrix(matrix)), rtol=1e-12)


def test_leading_eigenvalues_are_those_of_the_dense_matrix():
    n = 300
    laplacian = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1]) * (n + 1) ** 2
    rotation = sp.csc_matrix([[30.0, 8.0], [-8.0, 30.0]])
    matrix = (sp.kron(laplacian, sp.identity(2)) + sp.kron(sp.identity(n), rotation)).tocsc()
    right, up = Region().of(matrix)
    radius = float(np.hypot(right, up))
    start = np.random.default_rng(n).normal(size=2 * n)  # of this test alone, whichever tests run before
    found = leading(DirectLinear(matrix, Factoriser()), 2 * n, start, radius)
    inverse = splu(matrix.astype(complex))
    assert found.certain
    exact = np.linalg.eigvals(matrix.toarray())
    inside = exact[np.abs(exact) <= radius]
    assert len(found.values) >= len(inside)
    for value, vector in zip(found.values, found.vectors.T, strict=True):
        assert np.abs(exact - value).min() < 1e-3 * abs(value)
        # the residual that Arnoldi's method bounds is that of the inverse; A may magnify it by its condition
        residual = np.linalg.norm(inverse.solve(vector) - vector / value)
        assert residual <= 1.01 * CONVERGED * np.linalg.norm(vector / value)
    assert int(np.sum(found.values.real > 0)) == int(np.sum(exact.real > 0)) == 2


def test_krylov_and_direct_operators_agree():
    matrix = scattered(80)
    direct = DirectLinear(matrix, Factoriser())
    krylov = KrylovLinear(lambda v: matrix @ v, lambda v: v / 3.5)
    right = GENERATOR.normal(size=80)
    np.testing.assert_allclose(krylov.solve(right), direct.solve(right), atol=1e-8)
    border = GENERATOR.normal(size=(80, 1))
    both = (border, border[::-1].copy(), np.zeros((1, 1)))
    extended = np.append(right, 0.3)
    np.testing.assert_allclose(
        krylov.bordered(*both).solve(extended), direct.bordered(*both).solve(extended), atol=1e-7
    )
    np.testing.assert_allclose(
        krylov.shifted(0.5j).solve(right.astype(complex)), direct.shifted(0.5j).solve(right.astype(complex)), atol=1e-8
    )


def test_gmres_improves_a_guess_even_where_it_meets_the_tolerance():
    matrix = sp.diags([np.linspace(1.0, 2.0, 50)], [0])
    exact = GENERATOR.normal(size=50)
    guess = exact * (1.0 + 1e-8 * GENERATOR.normal(size=50))
    x, _, _ = gmres(lambda v: matrix @ v, lambda v: v, matrix @ exact, 1e-7, guess)
    assert np.linalg.norm(x - exact) < 1e-2 * np.linalg.norm(guess - exact)


def square(n, shift=0.0):
    """The discrete Laplacian on n x n inner points of the unit square, plus a shift: symmetric."""
    line = sp.diags([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], [-1, 0, 1]) * (n + 1) ** 2
    return (sp.kron(line, sp.identity(n)) + sp.kron(sp.identity(n), line) + shift * sp.identity(n * n)).tocsc()


def old_factors(matrix, near):
    return KrylovLinear(lambda v: matrix @ v, near.solve, near, matrix=matrix)


def preconditioned(matrix, near):
    return KrylovLinear(lambda v: matrix @ v, near.solve, matrix=matrix)


@pytest.mark.parametrize("kind", [old_factors, preconditioned])
def test_the_last_unknown_of_a_bordered_system_is_a_functional_of_its_right_hand_side(kind):
    """Where A is singular, too, and its factors are of a matrix nearby."""
    matrix = square(9)
    matrix = (matrix - np.linalg.eigvalsh(matrix.toarray())[-1] * sp.identity(81)).tocsc()
    near = Factoriser().factor(square(9, 5.0))
    b, c, right = (np.random.default_rng(k).normal(size=81) for k in range(3))
    exact = bordered(Factoriser().factor(square(9)), b[:, None], c[:, None], np.array([[0.5]]))
    assert exact.last_row() @ np.append(right, 0.3) == pytest.approx(exact.solve(np.append(right, 0.3))[-1], rel=1e-11)
    solver = kind(matrix, near).bordered(b[:, None], c[:, None], np.array([[0.5]]))
    whole = np.block([[matrix.toarray(), b[:, None]], [c[None], np.array([[0.5]])]])
    expected = np.linalg.inv(whole)[-1]
    np.testing.assert_allclose(solver.last_row(), expected, atol=1e-8 * np.abs(expected).max())


def test_there_is_no_such_functional_where_nothing_solves_with_the_transpose():
    matrix = (square(9) + sp.diags([np.ones(80)], [1])).tocsc()
    near = Factoriser().factor(matrix)
    borders = np.ones((81, 1)), np.ones((81, 1)), np.zeros((1, 1))
    assert preconditioned(matrix, near).bordered(*borders).last_row() is None
    assert KrylovLinear(lambda v: matrix @ v, near.solve).bordered(*borders).last_row() is None


@pytest.mark.parametrize("skew", [0.0, 40.0])
def test_eigenvalues_by_one_application_a_vector_are_those_of_the_operator(skew):
    """Unstable ones among them, with factors of a matrix nearby in place of an inverse."""
    n = 12
    matrix = (square(n, 60.0) + skew * sp.diags([np.ones(n * n - 1), -np.ones(n * n - 1)], [1, -1])).tocsc()
    near, applied = Factoriser().factor((matrix - 0.2 * sp.identity(n * n)).tocsc()), []

    def solve(right):
        applied.append(1 if right.ndim == 1 else right.shape[1])
        return near.solve(right)

    linear = KrylovLinear(lambda v: matrix @ v, solve, matrix=matrix)
    found = by_approximation(linear, 0.09, np.random.default_rng(4).normal(size=n * n), 0.0, 0.0, 4)
    whole = np.linalg.eigvals(matrix.toarray())
    for value, vector in zip(found.found.values, found.found.vectors.T, strict=True):
        assert np.abs(whole - value).min() <= CONVERGED * abs(value)
        assert np.linalg.norm(matrix @ vector - value * vector) <= 0.05 * abs(value) * np.linalg.norm(vector)
    assert np.abs(found.found.values - whole[np.argmin(np.abs(whole))]).min() <= CONVERGED * np.abs(whole).min()
    assert sum(applied) <= 60
