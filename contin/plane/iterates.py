"""Iterates of a planar map from a point."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.plane.field import PlanarField
from contin.plane.flights import Flight
from contin.simulate.run import simulate

COUNT: Final = 2000


def iterate(field: PlanarField, start: Array, window: Array) -> Flight:
    """The first iterates; 'left' where they grow beyond all bounds."""
    state = dict(zip(field.names, start.tolist(), strict=True))
    far = 1e3 * float(np.abs(window).max())
    found = simulate(field.planar, state, field.parameters, time=COUNT, box=far)
    return Flight(found.states, 1, "time" if found.complete else "left")
