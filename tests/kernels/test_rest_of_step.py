"""Room for further zeros of a test function, beside one that is located."""

import numpy as np
import pytest

from contin.kernels.rest_of_step import is_clear

PLACES = np.array([1e-6, 2e-6, 0.2, 0.5])  # of the way from `NEAR` to 1 from the zero at 0
NEAR = 1e-3


def looked_at(test, places=PLACES, crossing=True):
    """`is_clear` of one test, a function of the distance."""
    s = NEAR + np.append(places, 1.0) * (1.0 - NEAR)
    values = [np.array([test(x)]) for x in (NEAR, s[-1])]
    between = np.array([[test(x)] for x in s[:-1]])
    gaps = np.concatenate([[NEAR], s[2:]])
    return is_clear(values[0], between, values[1], places, gaps, np.array([int(crossing)]), False)


@pytest.mark.parametrize("places", [PLACES, PLACES[:3]])
def test_beside_a_simple_zero_alone_there_is_no_room(places):
    assert looked_at(lambda s: s * (1.0 + 0.1 * s), places)
    assert looked_at(lambda s: 2.0 - s, places, crossing=False)


@pytest.mark.parametrize("apart", [0.05, 0.2, 0.5])
def test_two_more_zeros_of_a_cubic_are_seen_whatever_their_distance(apart):
    assert not looked_at(lambda s: s * (s - 0.4) * (s - 0.4 - apart))
    assert not looked_at(lambda s: (s - 0.4) * (s - 0.4 - apart), crossing=False)


def test_a_value_that_is_no_larger_than_the_differences_beside_it_has_no_sign():
    assert not looked_at(lambda s: s + (1e-3 if 0.9e-6 < s - NEAR < 1.5e-6 else 0.0))
