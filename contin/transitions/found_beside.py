"""Tori beside points where their own equations say nothing: R1 and R2.

At R1 and R2 the squares of (multiplier - 1) and (multiplier + 1) vanish all along the curves of LPC and PD, so that the
equations of NS cannot tell its own curve from those. A torus bifurcation beside the point does: it is looked for along
short lines in one parameter, which start from orbits of a short family in the other one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import trace
from contin.errors import ContinError, InputError
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.transitions import births

if TYPE_CHECKING:
    from contin.abi import Array
    from contin.continuation.problem import Problem
    from contin.loci.orbits.special_orbits import OfSpecialOrbits

AWAY: Final = (0.01, 0.03)  # of the range of a parameter: how far the lines are from the point
REACH: Final = 0.25  # of the range of the other one: how far they go in both directions
QUICK: Final = Settings(steps=60, max_step=0.1)
WORK: Final = 4_000_000  # accepted points times unknowns, until the search is given up: some seconds
POINT: Final = 30  # a special point costs as much as so many others


def tori_beside(problem: OfSpecialOrbits, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of NS that passes nearest to the point; raises InputError where none is found."""
    here = np.array([point.values[name] for name in problem.parameters])
    widths = np.abs(point.scale[[-1, -2]])
    best: tuple[float, Problem, SpecialPoint] | None = None
    for family in _lines(problem, point, widths):
        for found in family.points:
            if found.type == "NS":
                there = np.array([found.values[name] for name in problem.parameters])
                gap = float(np.linalg.norm((there - here) / widths))
                if best is None or gap < best[0]:
                    best = gap, family.problem, found
        if best is not None:
            seeds: list[Seed] = births.loci(best[1], best[2], parameters)
            return seeds
    raise InputError(f"{point.branch}.{point.label}: no torus bifurcation was found beside this point")


def work_of(branch: Branch) -> int:
    """What a branch cost, in accepted points times unknowns."""
    return (branch.steps + POINT * len(branch.points)) * int(branch.z.shape[1])


def quick(orbits: OrbitProblem) -> Settings:
    """Settings of short families; orbits by collocation stay so, whatever the flow."""
    return replace(QUICK, method="collocation") if isinstance(orbits, OrbitProblem) else QUICK


def _lines(problem: OfSpecialOrbits, point: SpecialPoint, widths: Array) -> Iterator[Branch]:
    """Families along one parameter, through orbits that have the other one moved."""
    done = 0
    orbits, orbit = problem.curve.at(point.z), problem.curve.orbit(point.z)
    settings = quick(orbits)
    for axis in (0, 1):
        along, across = problem.parameters[axis], problem.parameters[1 - axis]
        moving = orbits if axis == 0 else orbits.with_active(along, orbit)
        value = float(point.values[along])
        start = np.append(orbit[:-1], value)
        for part in AWAY:
            bounds = value - part * widths[axis], value + part * widths[axis]
            try:
                family = trace(Seed(moving, start), bounds, settings=settings)
            except ContinError:  # one of several; where all fail, that is said
                continue
            done += work_of(family)
            for row in (0, -1):
                if done > WORK:
                    return
                z = family.z[row][~np.isnan(family.z[row])]
                line = moving.with_active(across, z)
                other = float(point.values[across])
                limits = other - REACH * widths[1 - axis], other + REACH * widths[1 - axis]
                try:
                    found = trace(Seed(line, np.append(z[:-1], other)), limits, settings=settings)
                except ContinError:  # one of several; where all fail, that is said
                    continue
                done += work_of(found)
                yield found
