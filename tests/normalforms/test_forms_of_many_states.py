"""Errors of coefficients where a form costs a way round an orbit: a few directions stand for all unit vectors."""

import numpy as np
import pytest

from contin.normalforms.jet import DerivativeJet
from contin.normalforms.static import MOST, are_dear, by_signs, quadratic_error


def cubic(n, calls, several=None):
    """D^2F = (a.v)(b.w) + (b.v)(a.w) times c, D^3F[v, w, z] = (a.v)(a.w)(d.z) + .. symmetric, times c."""
    a, b, c, d = np.random.default_rng(5).normal(size=(4, n))

    def derivative(directions):
        calls.append(len(directions))
        if len(directions) == 2:
            v, w = directions
            return ((a @ v) * (b @ w) + (b @ v) * (a @ w)) * c
        v, w, z = directions
        return ((a @ v) * (a @ w) * (d @ z) + (a @ v) * (a @ z) * (d @ w) + (a @ w) * (a @ z) * (d @ v)) * c

    return DerivativeJet(np.eye(n), derivative, kind="map", scale=np.ones(n), several=several), (a, b, c, d)


@pytest.mark.parametrize("seed", range(3))
def test_the_error_of_a_quadratic_form_takes_as_many_forms_of_many_states_as_of_few(seed):
    generator, n = np.random.default_rng(seed), 6 * MOST
    calls: list[int] = []
    jet, (a, _, c, d) = cubic(n, calls)
    assert are_dear(jet)
    p, v, w = generator.normal(size=(3, n))
    error = quadratic_error(jet, p, v, w, 1e-3)
    units = (a @ v) * (a @ w) * d + ((a @ v) * (d @ w) + (a @ w) * (d @ v)) * a
    exact = 1e-3 * abs(c @ p) * np.abs(units).sum()
    assert 0.5 * exact < error < 10.0 * exact
    assert len(calls) <= 10  # 2 n + 1 at unit vectors


def test_a_sum_over_units_is_about_bounded_by_few_directions():
    generator = np.random.default_rng(1)
    jet, _ = cubic(60, [])
    for _ in range(20):
        row, lengths = generator.normal(size=60), generator.uniform(size=60)
        bound = by_signs(jet, lengths, lambda d, row=row: abs(row @ d))
        assert 0.4 < bound / (lengths @ np.abs(row)) < 2.5


def test_of_few_states_every_unit_vector_is_asked():
    calls: list[int] = []
    jet, _ = cubic(MOST, calls)
    assert not are_dear(jet)
    p, v, w = np.random.default_rng(2).normal(size=(3, MOST))
    quadratic_error(jet, p, v, w, 1e-3)
    assert sum(1 for order in calls if order == 3) == MOST
