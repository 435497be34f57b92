"""Rows of a march: what was not marched keeps no memory."""

import numpy as np
import pytest

from contin.continuation.sample import Stop
from contin.problems.orbits.march.rows import Rows


@pytest.mark.parametrize(("marched", "held"), [(2, False), (9, True)])
def test_a_short_march_lets_the_memory_of_a_long_one_go(marched, held):
    out = Rows.of(10, 500, 4, 2)
    out.z[:], out.t[:], out.info[0] = np.arange(10.0)[:, None], 1.0, marched
    chunk = out.chunk(Stop.LIMIT)
    assert np.array_equal(chunk.z[:, 0], np.arange(marched + 1.0))
    assert (chunk.z.base is out.z) == (chunk.tangents.base is out.t) == held
