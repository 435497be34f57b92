"""Amplitudes beside a birth that a coarse mesh has moved: the note says by how much they are off, in closed form."""

import re

import numpy as np
import pytest

from tests.problems.large_orbits.cycles import family, planted


@pytest.mark.parametrize("intervals", [6, 10, 40])
def test_amplitudes_beside_a_birth_are_right_or_told(intervals):
    """r' = r (mu - r^2): on 6 intervals the first orbit was a fifth of its size."""
    orbits = family(planted(-1.0, 0.0), (-0.1, 0.02), intervals=intervals, steps=1, step=0.01)
    off = abs(1.0 - float(orbits.columns["x.max"][1]) / float(np.sqrt(orbits.columns["mu"][1])))
    notes = [note for note in orbits.notes if "the family is born" in note]
    assert bool(notes) == (off > 0.05)
    if notes:
        told = float(re.search(r"off by (\d+)%", notes[0])[1])
        assert abs(told - 100.0 * off) < 0.1 * 100.0 * off + 1.0
