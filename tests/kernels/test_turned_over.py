"""Whether an orbit has shrunk to a point on the way to the next one: seen from its mean, in any units of the states."""

import numpy as np
import pytest

from contin.kernels.special_orbits.predict import turned_over


def over(one, other, sizes):
    return turned_over(one.ravel(), other.ravel(), len(sizes), one.size, sizes)


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e9, 1e-9), (1e-12, 1e-12)])
def test_an_orbit_that_is_a_point_all_along_has_not_turned_over_by_rounding(units):
    """A forced cycle at rest, in the origin or beside it: curves of its folds ended there, by chance."""
    generator, units = np.random.default_rng(1), np.array(units)
    circle = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]])
    for mean in (0.0, 0.5):
        for _ in range(20):
            one, other = (mean + 1e-16 * generator.normal(size=circle.shape) for _ in range(2))
            assert not over(one * units, other * units, units)
        for radius in (1.0, 1e-6):
            assert over((mean + radius * circle) * units, (mean - 0.5 * radius * circle) * units, units)
            assert not over((mean + radius * circle) * units, (mean + 0.5 * radius * circle) * units, units)
