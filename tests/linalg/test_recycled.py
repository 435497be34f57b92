"""Krylov spaces that serve again: fewer iterations, the same solutions."""

import numpy as np
import pytest

from contin.linalg.krylov import gmres
from contin.linalg.recycled import MOST, Recycled

N = 120


def contraction(seed, nearest=0.3):
    """I - M with multipliers that fall fast, in skewed coordinates; one of them at a distance from 1."""
    generator = np.random.default_rng(seed)
    skewed = np.eye(N) + 0.3 * generator.normal(size=(N, N)) / np.sqrt(N)
    rates = 0.3 ** np.arange(N)
    rates[0] = 1.0 - nearest
    return np.eye(N) - skewed @ np.diag(rates) @ np.linalg.inv(skewed)


def solved(matrix, right, recycled=None):
    if recycled is None:
        return gmres(lambda v: matrix @ v, lambda r: r, right)
    return gmres(lambda v: matrix @ v, recycled.precondition, right, learn=recycled.learn)


def test_on_what_a_solve_has_seen_the_approximate_inverse_is_exact():
    matrix, recycled = contraction(0), Recycled()
    solved(matrix, np.random.default_rng(1).normal(size=N), recycled)
    images = recycled.blocks[0][1]
    np.testing.assert_allclose(images @ images.T, np.eye(len(images)), atol=1e-12)
    seen = np.random.default_rng(2).normal(size=len(images)) @ images
    np.testing.assert_allclose(matrix @ recycled.precondition(seen), seen, atol=1e-10)
    beyond = np.random.default_rng(3).normal(size=N)
    beyond -= images.T @ (images @ beyond)
    np.testing.assert_allclose(recycled.precondition(beyond), beyond, atol=1e-12)


@pytest.mark.parametrize("nearest", [0.3, 1e-3, 1e-7])
def test_later_solves_take_fewer_iterations_and_are_as_good(nearest):
    """Operators that drift, one of them nearly singular: 60 solves, beyond what is kept at a time."""
    generator, recycled = np.random.default_rng(4), Recycled()
    matrix = contraction(5, nearest)
    plain, taken = 0, 0
    for _ in range(60):
        right = generator.normal(size=N)
        x, iterations, _ = solved(matrix, right, recycled)
        before = solved(matrix, right)[1]
        size = np.linalg.norm(right)
        assert np.linalg.norm(matrix @ x - right) < 2e-11 * size + 1e-15 * np.linalg.norm(x) * N
        plain, taken = plain + before, taken + iterations
        assert sum(len(u) for u, _ in recycled.blocks) <= MOST
        matrix = matrix + 1e-4 * np.outer(generator.normal(size=N), generator.normal(size=N)) / N
    print(taken, plain)
    assert taken < 0.75 * plain
