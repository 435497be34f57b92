"""The curve through a fold of a branch of connecting orbits, in two parameters."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.homoclinic.cycle_connection_problem import ConnectionToCycle
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.loci.augmented import of_connections, tangencies
from contin.transitions.registry import born


@born(ConnectionToCycle, "LP", "the curve where the manifolds touch", parameters=2)
def with_cycles(problem: ConnectionToCycle, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of folds."""
    return [tangencies.curve_of(problem, point, parameters)]


@born(ConnectionProblem, "LP", "the curve where the manifolds touch", parameters=2)
def between_saddles(problem: ConnectionProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of folds."""
    return [of_connections.curve_of(problem, point, parameters)]
