"""Orbits on a few intervals that are asked for: where columns are off by more than a thousandth, a note says so."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin


@pytest.mark.parametrize("intervals", [4, 6, 20])
def test_columns_are_right_or_the_mesh_is_told(intervals):
    """The Brusselator's orbits, against trajectories: their largest x was off by 14 % on four intervals."""
    model = contin.load("classics/brusselator")
    line = contin.continuation(contin.equilibrium(model, parameters={"B": 1.9}), "B", (1.9, 2.1))
    settings = {"intervals": intervals}
    orbits = contin.continuation(line["HB1"].switch(), "B", (1.9, 2.6), settings=settings)
    flight = solve_ivp(
        lambda t, u: [1 - 3.6 * u[0] + u[0] ** 2 * u[1], 2.6 * u[0] - u[0] ** 2 * u[1]], (0, 100), [1, 2],
        method="DOP853", rtol=1e-9, atol=1e-9, t_eval=np.linspace(80, 100, 8001),
    )  # fmt: skip
    off = abs(orbits.columns["x.max"][-1] / flight.y[0].max() - 1.0)
    told = any("intervals is coarse" in note for note in orbits.notes)
    assert off < 1e-3 or told
    assert told == (intervals < 20)
