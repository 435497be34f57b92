"""Curves through points where their own equations say nothing: tori at R1 and R2, folds of doubled orbits at GPD.

At R1 and R2 the squares of (multiplier - 1) and (multiplier + 1) vanish all along the curves of LPC and PD, so that the
equations of NS cannot tell its own curve from those. A torus bifurcation beside the point does: it is looked for along
short lines in one parameter, which start from orbits of a short family in the other one.

At a GPD the doubled orbits that fold coincide with the orbit itself, gone through twice. Beside it on the curve of PD,
on one side, the doubled orbits born there fold at a distance: the first fold on their family is one of the curve.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import trace
from contin.errors import ContinError, InputError
from contin.problems.orbits.problem import OrbitProblem

AWAY: Final = (0.01, 0.03)  # of the range of a parameter: how far the lines are from the point
REACH: Final = 0.25  # of the range of the other one: how far they go in both directions
QUICK: Final = Settings(steps=60, max_step=0.1)
BESIDE: Final = (0.03, 0.1, 0.01)  # of the range of the parameter that moves more: orbits beside a GPD
WORK: Final = 4_000_000  # accepted points times unknowns, until the search is given up: some seconds
POINT: Final = 30  # a special point costs as much as so many others


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


def folds_of_doubled(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of folds (LPC) of doubled orbits that ends at a GPD; raises InputError where none is found."""
    done = 0
    widths = np.abs(point.scale[[-1, -2]])
    rates = point.tangent[[-1, -2]] / widths
    axis = int(np.argmin(np.abs(rates)))  # of the families, which the curve of PD crosses
    along, width = problem.parameters[axis], widths[axis]
    for part in BESIDE:
        for side in (part, -part):
            orbits, orbit = _doubling_beside(problem, point, side / rates[1 - axis], axis)
            if orbit is None or done > WORK:
                continue
            here, settings = float(orbit[-1]), _quick(orbits)
            bounds = here - AWAY[0] * width, here + AWAY[0] * width
            limits = here - REACH * width, here + REACH * width
            try:
                family = trace(Seed(orbits, orbit), bounds, settings=settings)
                done += work_of(family)
                doubling = min((p for p in family.points if p.type == "PD"), key=lambda p: abs(p.z[-1] - here))
                (seed,) = family.problem.switch(doubling, along)
                until = replace(settings, stop_at=("LPC",))
                doubled = trace(seed, limits, settings=until)
                done += work_of(doubled)
                fold = next(p for p in doubled.points if p.type == "LPC")
                return list(doubled.problem.loci(replace(fold, branch=point.branch, label=point.label), parameters))
            except (ContinError, ValueError, StopIteration):  # no doubling, or no fold on this side
                continue
    raise InputError(f"{point.branch}.{point.label}: no fold of doubled orbits was found beside this point")


def work_of(branch: Branch) -> int:
    """What a branch cost, in accepted points times unknowns."""
    return (branch.steps + POINT * len(branch.points)) * int(branch.z.shape[1])


def _doubling_beside(problem: Any, point: SpecialPoint, length: float, axis: int) -> tuple[Any, Any]:
    """The orbits in parameter `axis` and the one on the curve of PD where the tangent leads, None if there is none."""
    guess = point.z + length * point.tangent
    index = -1 if axis == 1 else -2
    z = problem.at_unknown(index, guess, float(guess[index]), point.scale)
    if z is None:
        return None, None
    orbits, orbit = problem.curve.at(z), problem.curve.orbit(z)
    if axis == 1:
        orbits = orbits.with_active(problem.parameters[1], orbit)
        orbit = np.append(orbit[:-1], z[-2])
    return orbits, orbit


def _quick(orbits: Any) -> Settings:
    """Settings of short families; orbits by collocation stay so, whatever the flow."""
    return replace(QUICK, method="collocation") if isinstance(orbits, OrbitProblem) else QUICK


def _lines(problem: Any, point: SpecialPoint, widths: Any) -> Iterator[Any]:
    """Families along one parameter, through orbits that have the other one moved."""
    done = 0
    orbits, orbit = problem.curve.at(point.z), problem.curve.orbit(point.z)
    settings = _quick(orbits)
    for axis in (0, 1):
        along, across = problem.parameters[axis], problem.parameters[1 - axis]
        moving = orbits if axis == 0 else orbits.with_active(along, orbit)
        value = float(point.values[along])
        start = np.append(orbit[:-1], value)
        for part in AWAY:
            bounds = value - part * widths[axis], value + part * widths[axis]
            try:
                family = trace(Seed(moving, start), bounds, settings=settings)
            except ContinError:
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
                except ContinError:
                    continue
                done += work_of(found)
                yield found
