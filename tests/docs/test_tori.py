"""The tori of the pair are born at the Neimark-Sacker point of its unequal orbit."""

import importlib
import sys

import numpy as np
import pytest

from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))
page = importlib.import_module("tori")


@pytest.mark.long
def test_small_beats_shrink_as_a_square_root_to_the_neimark_sacker_point():
    """It is at mu = 4.2084795 with the multipliers 0.99845 +- 0.05559i (run file pair-unequal-orbits)."""
    circles = page.family(4.207, 0.004)
    born = 4.2084795
    shares = [np.ptp(c.values[:, 1]) ** 2 / (born - c.p[0]) for c in circles[-2:]]
    assert shares[1] == pytest.approx(shares[0], rel=0.02)
    turns = [1 / abs(c.rho) for c in circles[-2:]]
    slope = (turns[1] - turns[0]) / (circles[-1].p[0] - circles[-2].p[0])
    assert turns[1] + slope * (born - circles[-1].p[0]) == pytest.approx(
        2 * np.pi / np.arctan2(0.0555943, 0.998453), rel=1e-3
    )
