"""Which way a branch that is born is followed first is no matter of rounding."""

import numpy as np
import pytest

from contin.transitions.oriented import oriented


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("seed", range(5))
def test_of_entries_alike_the_first_leads(seed, sign):
    # sin(2 pi t): its largest entries are equal and opposite, and rounding chooses among them
    wave = np.append(np.sin(2 * np.pi * np.linspace(0, 1, 41)), 0.0)
    rounding = 1.0 + 1e-15 * np.random.default_rng(seed).uniform(-1, 1, wave.size)
    found = oriented(sign * wave * rounding, np.ones(wave.size))
    np.testing.assert_allclose(found, wave, atol=1e-14)


def test_the_parameter_leads_where_it_changes_and_units_do_not_matter():
    direction = np.array([-1.0, 2.0, -1e-3])
    for scale in (np.ones(3), np.array([1e-3, 1e3, 1e-6])):  # dp is -.001 of |direction| and more
        np.testing.assert_array_equal(oriented(direction, scale), -direction)
    still = np.array([0.0, -1e-12, -2.0, 0.0])
    np.testing.assert_array_equal(oriented(still, np.ones(4)), -still)
