"""Multipliers of oscillations that are faster than the mesh are right, or told to be wrong."""

import numpy as np
import pytest
from scipy import sparse

import contin

LONG = pytest.mark.long  # as below: one is counted, the other told


@pytest.mark.parametrize(
    ("frequency", "intervals"),
    [pytest.param(3.3, 40, marks=LONG), (7.3, 20), (7.3, 40), pytest.param(20.3, 40, marks=LONG)],
)
@pytest.mark.seldom
def test_an_unstable_fast_mode_is_counted_or_told(frequency, intervals):
    """r' = r (mu - r^2) with angle t, and beside it an oscillation that grows by exp(0.02 t)."""

    def residual(u, p):
        x, y, a, b = u.tolist()
        growth = p["mu"] - x * x - y * y
        return np.array([growth * x - y, growth * y + x, 0.02 * a - frequency * b, frequency * a + 0.02 * b])

    def jacobian(u, p):
        x, y = u[:2].tolist()
        own = [[p["mu"] - 3 * x * x - y * y, -1 - 2 * x * y], [1 - 2 * x * y, p["mu"] - x * x - 3 * y * y]]
        return sparse.block_diag([own, [[0.02, -frequency], [frequency, 0.02]]], format="csc")

    problem = contin.FunctionProblem(residual, np.zeros(4), {"mu": -0.1}, jacobian, states=list("xyab"))
    hopf = contin.continuation(contin.equilibrium(problem), "mu", (-0.1, 0.1))["HB1"]
    orbits = contin.continuation(hopf.switch(), "mu", (-0.1, 0.1), settings={"intervals": intervals, "steps": 1})
    exact = float(np.exp(0.02 * 2.0 * np.pi))
    off = np.min(np.abs(np.abs(orbits.eigenvalues[-1]) - exact)) / exact
    told = any("faster than the mesh" in note for note in orbits.notes)
    assert told == (off > 0.05)
    assert told or orbits.columns["unstable"][-1] == 2
