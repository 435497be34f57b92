"""When many unknowns make points beside the start dear: which tests may dip there, seen from three rows."""

from dataclasses import dataclass

import numpy as np
import pytest

from contin.continuation.location.beside_ends import _falls
from contin.continuation.sample import Sample


@dataclass(frozen=True)
class Line:
    """Rows along one unknown."""

    @staticmethod
    def distance(a, b):
        return float(b.z[0] - a.z[0])


def falls(*tests):
    """Of rows at 0, 1 and 2."""
    rows = [Sample(np.array([s]), np.ones(1), np.array([f(s) for f in tests]), 0, np.empty(0)) for s in (0.0, 1.0, 2.0)]
    return _falls(Line(), *rows)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_test_dips_behind_the_start_where_its_parabola_does(sign):
    for lowest in (-0.3, 0.2, 0.4):
        dips = falls(lambda s, lowest=lowest: sign * (0.01 + (s - lowest) ** 2))
        assert dips == (lowest > 0.0)


def test_what_rises_and_what_falls_elsewhere_are_no_dip():
    assert not falls(lambda s: 0.1 + s, lambda s: 3.0 - s)


def test_a_test_that_does_not_move_is_no_dip_whatever_its_rounding():
    noise = dict(zip((0.0, 1.0, 2.0), (0.0, 3e-11, 1e-10), strict=True))
    assert not falls(lambda s: 0.998 + noise[s], lambda s: 0.998 * (1.0 - 1e-10 * s * (0.9 - s)))
