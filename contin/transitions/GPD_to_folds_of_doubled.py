"""The curve of folds of doubled orbits that ends at a generalised period doubling.

At a GPD the doubled orbits that fold coincide with the orbit itself, gone through twice. Beside it on the curve of PD,
on one side, the doubled orbits born there fold at a distance: the first fold on their family is one of the curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import trace
from contin.errors import ContinError, InputError
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.loci.shooting.shot_locus import ShotLocusProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.transitions import births
from contin.transitions.registry import born

BESIDE: Final = (0.03, 0.1, 0.01)  # of the range of the parameter that moves more: orbits beside a GPD
AWAY: Final = 0.01  # of the range of the other parameter: how far a family is followed to its doubling,
REACH: Final = 0.25  # ... and the doubled orbits to their fold
QUICK: Final = Settings(steps=60, max_step=0.1)
WORK: Final = 4_000_000  # accepted points times unknowns, until the search is given up: some seconds
POINT: Final = 30  # a special point costs as much as so many others


@born((OrbitLocusProblem, ShotLocusProblem), "GPD", "the curve of folds of doubled orbits", parameters=2)
def folds_of_doubled(problem: OrbitLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
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
            bounds = here - AWAY * width, here + AWAY * width
            limits = here - REACH * width, here + REACH * width
            try:
                family = trace(Seed(orbits, orbit), bounds, settings=settings)
                done += _work_of(family)
                doubling = min((p for p in family.points if p.type == "PD"), key=lambda p: abs(p.z[-1] - here))
                (seed,) = births.switch(family.problem, doubling, along)
                until = replace(settings, stop_at=("LPC",))
                doubled = trace(seed, limits, settings=until)
                done += _work_of(doubled)
                fold = next(p for p in doubled.points if p.type == "LPC")
                here_too = replace(fold, branch=point.branch, label=point.label)
                return births.loci(doubled.problem, here_too, parameters)
            except (ContinError, ValueError, StopIteration):  # no doubling, or no fold on this side
                continue
    raise InputError(f"{point.branch}.{point.label}: no fold of doubled orbits was found beside this point")


def _work_of(branch: Branch) -> int:
    """What a branch cost, in accepted points times unknowns."""
    return (branch.steps + POINT * len(branch.points)) * int(branch.z.shape[1])


def _quick(orbits: Any) -> Settings:
    """Settings of short families; orbits by collocation stay so, whatever the flow."""
    return replace(QUICK, method="collocation") if isinstance(orbits, OrbitProblem) else QUICK


def _doubling_beside(problem: OrbitLocusProblem, point: SpecialPoint, length: float, axis: int) -> tuple[Any, Any]:
    """The orbits in parameter `axis` and the one on the curve of PD where the tangent leads, None if there is none."""
    guess = point.z + length * point.tangent
    index = -1 if axis == 1 else -2
    z = problem.at_unknown(index, guess, float(guess[index]), point.scale)
    if z is None:
        return None, None
    orbits, orbit = problem.curve.family(z, second=axis == 1)
    return orbits, orbit
