"""Condensed linear algebra of orbits against dense matrices, and multipliers against exact products."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.kernels.collocation import LANES
from contin.kernels.collocation_basis import basis, interpolation
from contin.kernels.collocation_system import factorise, new_factors, solve
from contin.kernels.floquet import multipliers, transitions


@pytest.mark.parametrize("m", [2, 3, 4, 7])
def test_basis_differentiates_and_integrates_polynomials_of_its_degree_exactly(m):
    scheme = basis(m)
    p = np.polynomial.Polynomial(np.arange(1.0, m + 2.0))
    at_nodes = p(scheme.nodes)
    np.testing.assert_allclose(scheme.values @ at_nodes, p(scheme.gauss), rtol=1e-12)
    np.testing.assert_allclose(scheme.slopes @ at_nodes, p.deriv()(scheme.gauss), rtol=1e-11)
    np.testing.assert_allclose(scheme.top @ at_nodes, p.deriv(m)(0.3), rtol=1e-10)
    assert np.all(scheme.node_weights > 0.0)
    integral = p.integ()(1.0) - p.integ()(0.0)
    assert scheme.node_weights @ at_nodes == pytest.approx(integral, rel=1e-13)
    x = np.linspace(0.0, 1.0, 5)
    np.testing.assert_allclose(interpolation(m, x) @ at_nodes, p(x), rtol=1e-11)


def dense_system(a, border, n, m, sign_of_end, right, jump, border_right):
    """The whole matrix and right-hand side that the condensed elimination stands for."""
    intervals = a.shape[2]
    inner, nodes = (m - 1) * n, (intervals * m + 1) * n
    big, rhs = np.zeros((nodes + 2, nodes + 2)), np.zeros(nodes + 2)
    for i in range(intervals):
        left = i * m * n
        columns = [
            *range(left + n, left + n + inner),
            *range(left, left + n),
            *range(left + m * n, left + (m + 1) * n),
            nodes,
            nodes + 1,
        ]
        big[left : left + m * n, columns] += a[: m * n, :, i]
        rhs[left : left + m * n] = right[: m * n, i]
        big[nodes : nodes + 2, columns] += a[m * n :, :, i]
    k = np.arange(n)
    big[nodes - n + k, nodes - n + k] = 1.0
    big[nodes - n + k, k] -= sign_of_end
    rhs[nodes - n : nodes] = jump
    big[nodes:, nodes:] += border
    rhs[nodes:] = border_right
    return big, rhs


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 9), st.integers(2, 5), st.integers(2, 11), st.sampled_from([1.0, -1.0]), st.integers(0, 10**6))
def test_condensed_elimination_solves_the_whole_system_and_gives_the_sign_of_its_determinant(
    n, m, intervals, end, seed
):
    generator = np.random.default_rng(seed)
    a = generator.normal(size=(m * n + 2, (m + 1) * n + 2, intervals))
    a[m * n :, (m + 1) * n :] = 0.0
    border, border_right = generator.normal(size=(2, 2)), generator.normal(size=2)
    right, jump = generator.normal(size=(m * n + 2, intervals)), generator.normal(size=n)
    big, rhs = dense_system(a, border, n, m, end, right, jump, border_right)
    if np.linalg.cond(big) > 1e9:
        return
    s = new_factors(n, m, intervals)
    axis_first = n > LANES  # larger systems keep the intervals in front

    def stored(matrices):
        return np.moveaxis(matrices, -1, 0) if axis_first else matrices

    s.local[:], s.right_local[:] = stored(a), right
    sign = factorise(s, n, m, border, end)
    out = np.empty(len(rhs))
    solve(s, n, m, jump, border_right, end, True, out)
    exact = np.linalg.solve(big, rhs)
    np.testing.assert_allclose(out, exact, atol=1e-13 * np.linalg.cond(big) * np.abs(exact).max())
    flipped = a.copy()
    flipped[m * n + 1] *= -1.0  # one row with the other sign
    s.local[:] = stored(flipped)
    turned = factorise(s, n, m, border * np.array([[1.0], [-1.0]]), end)
    assert sign * turned == -1


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


@pytest.mark.parametrize("n", [1, 3, 5, 6, 11])
def test_transitions_solve_with_the_condensed_blocks(n):
    """M = -right^-1 left, also where the rows have to be exchanged."""
    m, intervals = 2, 3
    generator = np.random.default_rng(n)
    left, right = generator.normal(size=(2, intervals, n, n))
    right[0] = np.roll(np.eye(n), 1, axis=0) + 1e-3 * right[0]
    s, out = new_factors(n, m, intervals), np.empty((intervals, n, n))
    local = s.local if n > LANES else np.moveaxis(s.local, -1, 0)
    inner = (m - 1) * n
    local[:, inner : inner + n, inner : inner + n] = left
    local[:, inner : inner + n, inner + n : inner + 2 * n] = right
    assert transitions(s.local, n, m, out)
    np.testing.assert_allclose(right @ out, -left, atol=1e-11)
    local[1, inner, inner + n : inner + 2 * n] = 0.0
    assert not transitions(s.local, n, m, out)


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
