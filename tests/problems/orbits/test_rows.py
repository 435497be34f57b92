"""Rows of a march: what was not marched keeps no memory, and where they are looked between."""

import numpy as np
import pytest

from contin import api
from contin.continuation import end_of_step
from contin.continuation.sample import Stop
from contin.model.model import Model
from contin.problems.orbits.march import in_kernel
from contin.problems.orbits.march.rows import Rows


@pytest.mark.parametrize(("marched", "held"), [(2, False), (9, True)])
def test_a_short_march_lets_the_memory_of_a_long_one_go(marched, held):
    out = Rows.of(10, 500, 4, 2)
    out.z[:], out.t[:], out.info[0] = np.arange(10.0)[:, None], 1.0, marched
    chunk = out.chunk(Stop.LIMIT)
    assert np.array_equal(chunk.z[:, 0], np.arange(marched + 1.0))
    assert (chunk.z.base is out.z) == (chunk.tangents.base is out.t) == held


CANARD = Model(
    "canard", states={"x": 1.1, "y": -0.66}, parameters={"a": 1.1, "e": 0.05},
    equations={"x": "y - x^3/3 + x", "y": "e*(a - x)"},
)  # fmt: skip
FITZHUGH = Model(
    "fitzhugh", states={"x": 0, "y": 0}, parameters={"a": 0.2},
    equations={"x": "x - x^3/3 - y + a", "y": "0.08*(x + 0.7 - 0.8*y)"},
)  # fmt: skip


@pytest.mark.parametrize(("model", "bounds"), [(CANARD, (0.9, 1.2)), (FITZHUGH, (0.0, 2.0))])
def test_multipliers_of_rows_are_those_of_their_orbits(model, bounds):
    """Factors of the predicted points make errors of 2e-3 (and of 0.1 where multipliers are large)."""
    line = api.continuation(api.equilibrium(model), "a", bounds)
    cycles = api.continuation(line["HB1"].switch(), "a", bounds)
    for z, told in list(zip(cycles.z, cycles.eigenvalues, strict=True))[1:-1:5]:
        own = in_kernel.multipliers(cycles.problem, z[~np.isnan(z)])
        np.testing.assert_allclose(np.sort_complex(told), np.sort_complex(own), rtol=3e-4, atol=1e-6)


def test_a_step_is_looked_into_only_where_tests_of_its_own_factors_dip(monkeypatch):
    """Cycles of x' = y - x^3/3 + x, y' = e (a - x), whose parameter all but stands still once they are large: factors
    of a point nearby bend dp/ds by more than it is (6 looks in vain)."""
    looks = []
    monkeypatch.setattr(end_of_step, "resolve_dip", lambda *where: looks.append(where) or [])
    line = api.continuation(api.equilibrium(CANARD), "a", (0.9, 1.2))
    cycles = api.continuation(line["HB1"].switch(), "a", (0.9, 1.2))
    assert cycles.columns["x.max"][-1] - cycles.columns["x.min"][-1] > 3.5  # beyond the canards
    assert not looks
