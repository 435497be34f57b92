"""What a change of the determinant's sign within a step means: a crossing, a turn beside another curve, or a pole."""

import numpy as np
import pytest

from contin.continuation.turning_off import Solved, verdict_on

PLACE = 0.37


def step(determinant, apart=0.0, hidden=0.0):
    """The verdict on a step of length 1 of a line; beyond `PLACE` it is another one, `apart` from it.

    hidden : how near to the place no point is found.
    """

    def at(length):
        if abs(length - PLACE) < hidden:
            return None
        d = determinant(length - PLACE)
        return Solved(np.array([length, apart * (length > PLACE)]), np.sign(d), np.log(abs(d)))

    return verdict_on(at, at(0.0), at(1.0), 1.0, 1e-9)


def test_where_the_determinant_is_small_another_curve_crosses():
    verdict = step(lambda x: -x)
    assert verdict.length is None
    assert verdict.crossed


@pytest.mark.parametrize("hidden", [0.0, 1e-3, 0.05])
def test_a_pole_is_passed_and_no_crossing_also_where_no_point_is_found_beside_it(hidden):
    """AUTO's demo opt: a condition of a curve of extrema is infinite at an isola centre."""
    verdict = step(lambda x: -1.0 / x, hidden=hidden)
    assert verdict.length is None
    assert not verdict.crossed


@pytest.mark.parametrize("growing", [-1.5, 0.0, 1.5])
def test_a_curve_turns_off_beside_another_one_whichever_way_the_determinant_changes_along_it(growing):
    verdict = step(lambda x: -np.sign(x) * np.hypot(x, 0.01) * np.exp(growing * x), apart=0.01)
    assert verdict.length is not None
    assert verdict.length < PLACE
    assert verdict.most == pytest.approx(0.01, rel=1e-2)
