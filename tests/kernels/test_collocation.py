"""Condensed linear algebra of orbits against dense matrices, and multipliers against exact products."""

from math import comb, factorial, fsum

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.kernels.collocation import LANES, Equations, new_points
from contin.kernels.collocation_basis import basis, interpolation
from contin.kernels.collocation_dense import invert_dense
from contin.kernels.collocation_elimination import invert
from contin.kernels.collocation_system import factorise, new_factors, solve
from contin.kernels.filling import fill
from contin.kernels.floquet import multipliers, transitions


def coefficient_sizes(nodes, j):
    """Sum of the moduli of the coefficients of the Lagrange polynomial of a node."""
    others = np.delete(nodes, j)
    return np.abs(np.polynomial.Polynomial.fromroots(others).coef).sum() / abs(np.prod(nodes[j] - others))


@pytest.mark.parametrize("m", [2, 3, 4, 7])
def test_basis_differentiates_and_integrates_polynomials_of_its_degree_exactly(m):
    scheme = basis(m)
    p = np.polynomial.Polynomial(np.arange(1.0, m + 2.0))
    at_nodes = p(scheme.nodes)
    # the Lagrange polynomials are evaluated by powers: rounding is that of the sum of their coefficients' sizes
    sizes = [coefficient_sizes(scheme.nodes, j) for j in range(m + 1)]
    rounding = np.finfo(float).eps * (np.abs(at_nodes) @ sizes)
    np.testing.assert_allclose(scheme.values @ at_nodes, p(scheme.gauss), rtol=0.0, atol=rounding)
    np.testing.assert_allclose(scheme.slopes @ at_nodes, p.deriv()(scheme.gauss), rtol=0.0, atol=m * rounding)
    np.testing.assert_allclose(scheme.top @ at_nodes, p.deriv(m)(0.3), rtol=0.0, atol=factorial(m) * rounding)
    assert np.all(scheme.node_weights > 0.0)
    integral = p.integ()(1.0) - p.integ()(0.0)
    assert scheme.node_weights @ at_nodes == pytest.approx(integral, rel=1e-13)
    x = np.linspace(0.0, 1.0, 5)
    np.testing.assert_allclose(interpolation(m, x) @ at_nodes, p(x), rtol=1e-11)


def random_problem(generator, n, m, intervals):
    """Equations, values at the Gauss points, and z of a made-up orbit: everything that the matrix is made of."""
    scheme = basis(m)
    e = Equations(
        0, 0, 0, 1, n, m, 0, scheme.values, scheme.slopes, scheme.gauss, scheme.gauss_weights, np.zeros(n), np.zeros(n),
    )  # fmt: skip
    w = new_points(n, m, intervals, np.zeros(1))
    for values in (w.f, w.fu, w.fp, w.phase):
        values[:] = generator.normal(size=values.shape)
    w.h[:] = generator.dirichlet(np.full(intervals, 3.0))
    nodes = (intervals * m + 1) * n
    z = np.concatenate([generator.normal(size=nodes), [generator.uniform(1.0, 3.0 * intervals)], w.h, [0.3]])
    tangent, scale = generator.normal(size=z.size), generator.uniform(0.3, 3.0, z.size)
    return e, w, z, tangent, scale


def dense_system(e, w, z, tangent, scale, sign_of_end, right, jump, border_right):
    """The whole matrix in the values at the nodes, and right-hand side, that the condensed elimination stands for."""
    scheme, n, m, intervals = basis(e.m), e.n, e.m, w.h.size
    nodes = (intervals * m + 1) * n
    period = z[nodes]
    fu = w.fu if n > LANES else np.moveaxis(w.fu, -1, 0)
    big, rhs = np.zeros((nodes + 2, nodes + 2)), np.zeros(nodes + 2)
    for i in range(intervals):
        columns = np.arange(i * m * n, (i * m + m + 1) * n)
        for c in range(m):
            rows = (i * m + c) * n + np.arange(n)
            collocation = -period * w.h[i] * np.kron(scheme.values[c], fu[i, c])
            big[np.ix_(rows, columns)] = np.kron(scheme.slopes[c], np.eye(n)) + collocation
            big[rows, nodes], big[rows, nodes + 1] = -w.h[i] * w.f[c, :, i], -w.h[i] * period * w.fp[c, :, i]
            rhs[rows] = right[c * n : (c + 1) * n, i]
        big[nodes, columns] += np.kron(scheme.values.T, np.eye(n)) @ w.phase[:, :, i].ravel()
    k = np.arange(n)
    big[nodes - n + k, nodes - n + k] = 1.0
    big[nodes - n + k, k] -= sign_of_end
    rhs[nodes - n : nodes] = jump
    unknowns = np.append(np.arange(nodes + 1), z.size - 1)
    big[nodes + 1] = (tangent / scale)[unknowns]
    rhs[nodes:] = border_right
    return big, rhs


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from([1, 2, 3, 4, 6, 9, LANES, LANES + 1, LANES + 4]), st.integers(2, 7), st.integers(2, 11),
    st.sampled_from([1.0, -1.0]), st.integers(0, 10**6),
)  # fmt: skip
def test_condensed_elimination_solves_the_whole_system_and_gives_the_sign_of_its_determinant(
    n, m, intervals, end, seed
):
    generator = np.random.default_rng(seed)
    e, w, z, tangent, scale = random_problem(generator, n, m, intervals)
    border, border_right = np.zeros((2, 2)), generator.normal(size=2)
    right, jump = generator.normal(size=(m * n, intervals)), generator.normal(size=n)
    big, rhs = dense_system(e, w, z, tangent, scale, end, right, jump, border_right)
    condition = np.linalg.cond(big)
    if condition > 1e9:
        return
    s = new_factors(n, m, intervals)
    s.right_local[:] = right
    sign = fill(e, w, z, tangent, scale, s, border) * factorise(s, n, m, border, end)
    out = np.empty(len(rhs))
    solve(s, n, m, jump, border_right, end, True, out)
    exact = np.linalg.solve(big, rhs)
    np.testing.assert_allclose(out, exact, atol=1e-12 * condition * np.abs(exact).max())
    other = tangent + generator.normal(size=tangent.size)  # the sign changes with that of the whole determinant
    border = np.zeros((2, 2))
    again = fill(e, w, z, other, scale, s, border) * factorise(s, n, m, border, end)
    turned, _ = dense_system(e, w, z, other, scale, end, right, jump, border_right)
    assert sign * again == np.linalg.slogdet(big)[0] * np.linalg.slogdet(turned)[0]


@pytest.mark.parametrize(("n", "m"), [(1, 2), (3, 4), (4, 7), (5, 3), (11, 4)])
def test_transitions_of_a_linear_equation_are_those_of_gauss_collocation(n, m):
    """u' = A u: M = R(h T A) with the diagonal Pade approximant R of exp (Hairer and Wanner, section IV.3)."""
    generator = np.random.default_rng(n)
    e, w, z, tangent, scale = random_problem(generator, n, m, 3)
    matrix = generator.normal(size=(n, n))
    w.fu[:] = matrix if n > LANES else matrix[None, :, :, None]
    s, border = new_factors(n, m, 3), np.zeros((2, 2))
    assert fill(e, w, z, tangent, scale, s, border) != 0
    assert factorise(s, n, m, border, 1.0) != 0
    out = np.empty((3, n, n))
    transitions(s.local, n, m, np.ones(n), out)
    powers = [comb(m, k) * factorial(2 * m - k) / factorial(2 * m) for k in range(m + 1)]
    for i, h in enumerate(w.h):
        x = h * z[3 * m * n + n] * matrix
        above = sum(powers[k] * np.linalg.matrix_power(x, k) for k in range(m + 1))
        below = sum(powers[k] * np.linalg.matrix_power(-x, k) for k in range(m + 1))
        np.testing.assert_allclose(out[i], np.linalg.solve(below, above), rtol=1e-9, atol=1e-10)


def test_multipliers_of_1e12_and_1e_minus_12_keep_nine_digits_each():
    generator = np.random.default_rng(3)
    exact = np.array([1e12, 30.0, 0.5, 1e-12])
    count, n = 60, 4
    bases = [np.linalg.qr(generator.normal(size=(n, n)))[0] for _ in range(count)]
    factors = np.exp(np.log(exact) / count)
    cycle = np.array([bases[(i + 1) % count] @ np.diag(factors) @ bases[i].T for i in range(count)])
    re, im = np.full(n, np.nan), np.zeros(n)
    assert multipliers(cycle, 0, np.full((n, n), np.nan), re, im)
    np.testing.assert_allclose(np.sort(re)[::-1], exact, rtol=1e-9)
    np.testing.assert_allclose(im, 0.0)


def test_a_complex_pair_of_multipliers_survives_beside_a_tiny_one():
    angle, count = 0.7, 40
    turn = np.array([[np.cos(angle / count), -np.sin(angle / count)], [np.sin(angle / count), np.cos(angle / count)]])
    step = np.zeros((3, 3))
    step[:2, :2], step[2, 2] = turn, 1e-9 ** (1.0 / count)
    re, im = np.full(3, np.nan), np.zeros(3)
    assert multipliers(np.array([step] * count), 0, np.full((3, 3), np.nan), re, im)
    found = sorted(re + 1j * im, key=lambda v: v.imag)
    np.testing.assert_allclose(found, [np.exp(-1j * angle), 1e-9, np.exp(1j * angle)], rtol=1e-10)


def test_ten_multipliers_over_ten_orders_of_magnitude_keep_nine_digits_each():
    generator = np.random.default_rng(8)
    exact, count = np.geomspace(1e3, 1e-7, 10), 30
    bases = [np.linalg.qr(generator.normal(size=(10, 10)))[0] for _ in range(count)]
    factors = np.exp(np.log(exact) / count)
    cycle = np.array([bases[(i + 1) % count] @ np.diag(factors) @ bases[i].T for i in range(count)])
    re, im = np.full(10, np.nan), np.zeros(10)
    assert multipliers(cycle, 0, np.full((10, 10), np.nan), re, im)
    np.testing.assert_allclose(np.sort(re)[::-1], exact, rtol=1e-9)
    np.testing.assert_allclose(im, 0.0)


@pytest.mark.parametrize("d", [1, 2, 3, 4, 7, 10, 13, 22])
def test_inverses_in_place_also_where_rows_have_to_be_exchanged(d):
    generator = np.random.default_rng(d)
    a = generator.normal(size=(5, d, d))
    a[1] = np.roll(np.eye(d), 1, axis=0) + 1e-3 * a[1]
    signs = np.linalg.slogdet(a)[0]
    lanes = np.moveaxis(a, 0, -1).copy()
    assert invert(lanes, np.zeros((d, 5), np.int64), np.ones(d), np.ones((d, 5)), np.zeros(5)) == np.prod(signs)
    one_by_one = a.copy()
    ones, memory = np.ones(d), np.ones((d, 1))
    found = [invert_dense(one_by_one, i, np.zeros((5, d), np.int64), ones, memory, np.zeros((4, d))) for i in range(5)]
    np.testing.assert_array_equal(found, signs)
    for inverse in (np.moveaxis(lanes, -1, 0), one_by_one):
        np.testing.assert_allclose(inverse @ a, np.broadcast_to(np.eye(d), a.shape), atol=1e-9)
    a[2, :, 0] = 0.0
    assert invert_dense(a, 2, np.zeros((5, d), np.int64), np.ones(d), np.ones((d, 1)), np.zeros((4, d))) == 0


@pytest.mark.parametrize("m", range(2, 8))
def test_a_constant_has_no_slope_and_its_value_everywhere(m):
    """To the last digit: a row sum acts as a growth rate in every interval, and moved folds of cycles by 2e-13."""
    scheme = basis(m)
    assert max(abs(fsum(row)) for row in scheme.slopes.tolist()) < 1e-17
    assert max(abs(fsum([*row, -1.0])) for row in scheme.values.tolist()) < 1e-17
    assert abs(fsum(scheme.top.tolist())) <= 1e-15 * np.abs(scheme.top).max()


@pytest.mark.parametrize("m", range(2, 8))
def test_polynomials_of_the_degree_of_the_scheme_are_differentiated_to_rounding(m):
    """Values, slopes and the m-th derivative of t^k, k <= m, to a few units of the last place of the terms summed."""
    scheme, rounding = basis(m), 4.0 * np.finfo(float).eps
    size, steep, top = (np.abs(matrix).sum(axis=-1) for matrix in (scheme.values, scheme.slopes, scheme.top))
    for k in range(m + 1):
        u, slope = scheme.nodes**k, k * scheme.gauss ** max(k - 1, 0)
        assert np.all(np.abs(scheme.values @ u - scheme.gauss**k) <= rounding * size)
        assert np.all(np.abs(scheme.slopes @ u - slope) <= rounding * steep)
        assert abs(scheme.top @ u - (factorial(m) if k == m else 0.0)) <= rounding * top
