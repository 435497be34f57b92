"""Orbits by shooting with multipliers beyond 1/eps: events of the others are told as lost, and the branch goes on."""

import numpy as np
import pytest

from contin.continuation.location.isolate import HALVINGS, isolate
from contin.continuation.outcome import NOTHING
from contin.continuation.sample import Sample
from tests.truth.test_orbits_in_one_step import family


@pytest.mark.seldom
def test_period_doublings_are_found_and_what_rounding_hides_is_told():
    """At p = 1 a multiplier is e^(20 pi) = 2e27; halving a step between signs of rounding took hours."""
    branch = family("PD", 0.1, "shooting")
    np.testing.assert_allclose([p.z[-1] for p in branch.points], [-0.1, 0.0, 0.1], atol=1e-9)
    assert {p.type for p in branch.points} == {"PD"}
    assert any("lost in their rounding errors" in note for note in branch.notes)
    assert branch.unexplained > 0
    assert [end.reason for end in branch.ends] == ["bound", "bound"]


class _Noise:
    """A stretch of a problem that finds an unknown change between any two points."""

    class problem:
        multiplied_out, kind = False, "orbit"

        @staticmethod
        def explain(a, b):
            return None

        @staticmethod
        def verify_corner(a, b, frame):
            return NOTHING

        @staticmethod
        def together(a, b):
            return ()

    frame = base = None

    def __init__(self):
        self.halved = []

    def distance(self, a, b):
        return abs(b.z[0] - a.z[0])

    def between(self, a, b, fraction):
        return _sample(a.z[0] + fraction * (b.z[0] - a.z[0]))


def _sample(s):
    one = np.ones(1)
    return Sample(np.array([s]), one, np.ones(4), 0, one.astype(complex))


def test_changes_everywhere_are_not_halved_for_ever():
    stretch = _Noise()
    assert list(isolate(stretch, _sample(0.0), _sample(1.0))) == []
    assert len(stretch.halved) == HALVINGS
