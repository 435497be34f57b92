"""The family of orbits through a point of a curve of orbits, in one parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.model.advice import place_of_parameter
from contin.problems.orbits.two_parameters import OfPeriodicOrbits
from contin.transitions.registry import born

if TYPE_CHECKING:
    from contin.loci.equilibria.equilibrium_locus import LocusProblem


@born(OfPeriodicOrbits, "", "the family of orbits")
def orbits_through(problem: LocusProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the family."""
    place_of_parameter(parameter, problem.system.parameter_names)
    return [Seed(*problem.curve.at(point.z).freed(parameter, problem.curve.orbit(point.z)))]


@born(ConnectionProblem, "", "nothing")
def no_connection(problem: LocusProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Raises InputError: there is no family."""
    raise InputError(f"{point.branch}.{point.label}: one connecting orbit is isolated in one parameter; give two")
