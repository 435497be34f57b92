"""Curves of tori through points where the equations of such curves have another solution too.

At R1 and R2 the squares of (multiplier - 1) and (multiplier + 1) vanish all along the curves of LPC and PD, so that the
equations of NS cannot tell its own curve from those. A torus bifurcation beside the point does: it is looked for along
short lines in one parameter, which start from orbits of a short family in the other one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.errors import ContinError, InputError
from contin.kernels.clock import computing_time

AWAY: Final = (0.01, 0.03)  # of the range of a parameter: how far the lines are from the point
REACH: Final = 0.25  # of the range of the other one: how far they go in both directions
QUICK: Final = Settings(steps=60, max_step=0.1)
SECONDS: Final = 10.0  # until the search is given up: families beside long orbits have many special points


def tori_beside(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of NS that passes nearest to the point; raises InputError where none is found."""
    here = np.array([point.values[name] for name in problem.parameters])
    widths = np.abs(point.scale[[-1, -2]])
    best: tuple[float, Any, SpecialPoint] | None = None
    for family in _lines(problem, point, widths):
        for found in family.points:
            if found.type == "NS":
                there = np.array([found.values[name] for name in problem.parameters])
                gap = float(np.linalg.norm((there - here) / widths))
                if best is None or gap < best[0]:
                    best = gap, family.problem, found
        if best is not None:
            seeds: list[Seed] = best[1].loci(best[2], parameters)
            return seeds
    raise InputError(f"{point.branch}.{point.label}: no torus bifurcation was found beside this point")


def _lines(problem: Any, point: SpecialPoint, widths: Any) -> Iterator[Any]:
    """Families along one parameter, through orbits that have the other one moved."""
    from contin.continuation.trace import trace

    deadline = computing_time() + SECONDS
    orbits, orbit = problem.curve.at(point.z), problem.curve.orbit(point.z)
    for axis in (0, 1):
        along, across = problem.parameters[axis], problem.parameters[1 - axis]
        moving = orbits if axis == 0 else orbits.with_active(along, orbit)
        value = float(point.values[along])
        start = np.append(orbit[:-1], value)
        for part in AWAY:
            bounds = value - part * widths[axis], value + part * widths[axis]
            try:
                family = trace(Seed(moving, start), bounds, settings=QUICK, deadline=deadline)
            except ContinError:
                continue
            for row in (0, -1):
                if computing_time() > deadline:
                    return
                z = family.z[row][~np.isnan(family.z[row])]
                line = moving.with_active(across, z)
                other = float(point.values[across])
                limits = other - REACH * widths[1 - axis], other + REACH * widths[1 - axis]
                try:
                    yield trace(Seed(line, np.append(z[:-1], other)), limits, settings=QUICK, deadline=deadline)
                except ContinError:
                    continue
