"""Families of piecewise-linear orbits whose period diverges at an equilibrium on a corner of the equations."""

import numpy as np

import contin
from contin.model.model import Model

A, B = 0.25, 0.5
MCKEAN = Model(
    "mckean", states={"v": 0, "w": 0}, parameters={"I": 0.5, "a": A, "b": B, "eps": 0.1},
    equations={
        "v": "(-v if v < a/2 else (v - a if v < (1 + a)/2 else 1 - v)) - w + I",
        "w": "eps*(v - b*w)",
    },
)  # fmt: skip


def test_orbits_of_mckeans_neuron_begin_and_end_where_its_equilibrium_meets_a_corner():
    """The middle piece has an unstable node: orbits are born large where the equilibrium passes v = a/2, (1 + a)/2."""
    start = contin.periodic_orbit(MCKEAN, {"v": 0.0, "w": 0.0})
    family = contin.continuation(start, "I", (-0.5, 2.0))
    assert [end.reason for end in family.ends] == ["surface", "surface"]
    low, high = A / 2 + A / 2 / B, (1 + A) / 2 / B - (1 + A) / 2 + A
    assert family.ends[0].data["at"]["I"] == np.clip(family.ends[0].data["at"]["I"], low, low + 1e-5)
    assert family.ends[1].data["at"]["I"] == np.clip(family.ends[1].data["at"]["I"], high - 1e-5, high)
    assert "v - a/2 = 0" in family.ends[0].text
    assert not family.notes
    assert np.all(np.isfinite(family.columns["v.max"]))
