"""Curves of special orbits through a point where two of them meet."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.loci.shooting.curve import ShootingCurve
from contin.loci.shooting.shot_locus import ShotLocusProblem
from contin.problems.orbits.special_orbits.curve import OrbitCurve
from contin.transitions.registry import born
from contin.transitions.special_orbits import seeds_through


@born(OrbitLocusProblem, "", "the other curves through it", parameters=2)
def by_collocation(problem: OrbitLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """See `seeds_through`."""
    return seeds_through(OrbitCurve, OrbitLocusProblem, problem, point, parameters)


@born(ShotLocusProblem, "", "the other curves through it", parameters=2)
def by_shooting(problem: ShotLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """See `seeds_through`."""
    return seeds_through(ShootingCurve, ShotLocusProblem, problem, point, parameters)
