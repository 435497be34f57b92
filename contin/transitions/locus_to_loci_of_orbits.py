"""Curves of special orbits through a point where two of them meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.problems.orbits.loci.curve import OrbitCurve
from contin.problems.orbits.loci.problem import OrbitLocusProblem
from contin.problems.shooting.loci.curve import ShootingCurve
from contin.problems.shooting.loci.problem import ShotLocusProblem
from contin.transitions.registry import born
from contin.transitions.special_orbits import seeds_through

if TYPE_CHECKING:
    pass



@born(OrbitLocusProblem, "", "the other curves through it", parameters=2)
def by_collocation(problem: OrbitLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """See `seeds_through`."""
    return seeds_through(OrbitCurve, OrbitLocusProblem, problem, point, parameters)


@born(ShotLocusProblem, "", "the other curves through it", parameters=2)
def by_shooting(problem: ShotLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """See `seeds_through`."""
    return seeds_through(ShootingCurve, ShotLocusProblem, problem, point, parameters)
