"""Newton's method: its order, how it ends, and that it says so where it does not."""

from __future__ import annotations

import numpy as np
import pytest

from contin.linalg.newton import Rules, by_steps, newton, solution, with_one_fixed

SQUARE_ROOT = np.sqrt(2.0)


def root(z):
    """x^2 = 2"""
    return -(z * z - 2.0) / (2.0 * z)


def test_it_converges_quadratically_to_full_precision():
    seen = []

    def correct(z):
        seen.append(abs(z - SQUARE_ROOT))
        return abs(root(z)), z + root(z)

    found = newton(correct, 3.0, Rules())
    assert found.at == pytest.approx(SQUARE_ROOT, abs=4e-16)
    assert len(seen) <= 8
    errors = np.array([e for e in seen if e > 1e-6])
    np.testing.assert_allclose(errors[1:], errors[:-1] ** 2 / (2.0 * (SQUARE_ROOT + errors[:-1])), rtol=1e-8)


def test_scaled_unknowns_take_the_same_way():
    one = by_steps(root, np.array([3.0]), 1.0, Rules())
    kilo = by_steps(lambda z: root(z / 1e3), np.array([3e3]), 1e3, Rules())
    assert kilo.at == pytest.approx(1e3 * one.at, rel=1e-15)
    assert kilo.made == pytest.approx(one.made, abs=1e-15)


def test_corrections_that_are_rounding_are_not_made_and_their_size_is_told():
    noise = iter([1e-3, 1e-9, 0.95e-9])
    found = newton(lambda z: (step := next(noise), z + step), 0.0, Rules(settled=1e-14, stalled=1e-8))
    assert found.at == 1e-3 + 1e-9
    assert (found.made, found.left) == (1e-9, 0.95e-9)


def test_corrections_that_fall_like_a_series_are_no_rounding():
    """At a fourfold zero each leaves 3/4 of the error: where the fifth below `stalled` was the last, 3e-9 were left."""
    found = newton(lambda z: (abs(z) / 4.0, 0.75 * z), 1.0, Rules(stalled=1e-8, settled=1e-14, budget=200))
    assert abs(found.at) < 5e-14
    short = newton(lambda z: (abs(z) / 4.0, 0.75 * z), 1e-8, Rules(stalled=1e-8, settled=1e-14, budget=4))
    assert short.exhausted
    assert short.left == pytest.approx(abs(short.at), rel=1e-12)  # what is left is the sum of the series


def test_rounding_may_grow_and_other_corrections_may_not():
    rules = Rules(settled=1e-17, stalled=1e-7, growth=2.0)
    noise = iter([1e-3, 1e-16, 9e-15])
    found = newton(lambda z: (step := next(noise), z + step), 0.0, rules)
    assert (found.made, found.left) == (1e-16, 9e-15)
    larger = iter([1e-3, 1e-4, 9e-3])
    assert newton(lambda z: (step := next(larger), z + step), 0.0, rules) is None


def test_a_double_root_is_approached_by_halves_until_corrections_stall():
    found = newton(lambda z: (abs(z) / 2.0, z / 2.0), 1.0, Rules(stalled=1e-8, budget=60))  # z^2 = 0
    assert abs(found.at) <= 2e-8


@pytest.mark.parametrize(
    ("correct", "why"),
    [
        (lambda z: None, "no correction"),
        (lambda z: (np.nan, z), "not finite"),
        (lambda z: (2.0, z), "too far"),
        (lambda z: (0.5, z + 0.5), "never ends"),
    ],
)
def test_where_it_does_not_converge_there_is_nothing(correct, why):
    assert newton(correct, 0.0, Rules(far=1.0)) is None, why


def test_a_singular_matrix_has_no_solution():
    assert solution(np.zeros((2, 2)), np.ones(2)) is None
    np.testing.assert_array_equal(solution(2.0 * np.eye(2), np.ones(2)), [0.5, 0.5])


def test_a_point_of_the_circle_with_one_coordinate_held():
    def circle(z):
        return np.array([z @ z - 1.0]), 2.0 * z[None]

    for index in (0, 1):
        z = with_one_fixed(circle, index, np.array([0.7, 0.8]), 0.6, np.ones(2))
        assert z[index] == 0.6
        assert z[1 - index] == pytest.approx(0.8, abs=1e-15)
