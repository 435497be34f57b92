"""Iterates of a map in one call are those that `value` gives one by one, to the last bit."""

import numpy as np
import pytest

import contin
from contin.api import compiled
from contin.systems import steps
from contin.systems.iterate import iterate

P = np.array([1.4, 0.3])


def one_by_one(system, u, count):
    points = [np.asarray(u)]
    for _ in range(count):
        points.append(system.value(points[-1], P))
    return np.array(points)


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("count", [0, 1, steps.AT_ONCE, 3 * steps.AT_ONCE + 7])
def test_iterates_are_those_of_single_calls(times, count):
    """On Henon's attractor, where an error in the last bit is all of it after a hundred iterates."""
    system = iterate(compiled(contin.load("henon")), times)
    found = steps.iterates(system, np.array([0.1, 0.1]), P, count, 10.0)
    np.testing.assert_array_equal(found, one_by_one(system, [0.1, 0.1], count))


@pytest.mark.parametrize("times", [1, 2])
def test_the_last_one_is_the_first_beyond_the_box(times):
    system = iterate(compiled(contin.load("henon")), times)
    found = steps.iterates(system, np.array([2.0, 0.0]), P, 1000, 100.0)
    assert np.abs(found[:-1]).max() <= 100.0 < np.abs(found[-1]).max()
    np.testing.assert_array_equal(found, one_by_one(system, [2.0, 0.0], len(found) - 1))


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"points must be \(N, 2\)"):
        compiled(contin.load("henon")).steps(np.zeros((3, 4))[:, :2], P)
