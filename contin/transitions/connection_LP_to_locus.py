"""The curve through a fold of a branch of connecting orbits with a cycle, in two parameters."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.homoclinic.cycle_connection_problem import ConnectionToCycle
from contin.loci.augmented.tangencies import curve_of
from contin.transitions.registry import born


@born(ConnectionToCycle, "LP", "the curve where the manifolds touch", parameters=2)
def tangencies(problem: ConnectionToCycle, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of folds."""
    return [curve_of(problem, point, parameters)]
