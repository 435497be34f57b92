"""What is born on families of orbits with jumps: the family that crosses, and orbits of twice the period."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.normalforms.maps import flip_predictor
from contin.problems.equilibria.normal_forms import jet_at
from contin.problems.hybrid.hybrid_orbits import HybridOrbits
from contin.transitions.orbit_BPC_to_crossing import CROSSING
from contin.transitions.orbit_PD_to_doubled import CASCADE
from contin.transitions.orbits_at_point import along_own_parameter, unstable_count
from contin.transitions.registry import born

PARALLEL: Final = 0.999  # cosine between tangents from which two families are one


@born(HybridOrbits, "BPC", "the family that crosses", explored=CROSSING)
def crossing_family(problem: HybridOrbits, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the family along the tangent that is not the point's own."""
    along_own_parameter(problem, point, parameter)
    own = point.tangent / point.scale
    own = own / np.linalg.norm(own)
    others = [t for t in problem.tangents(point.z, point.scale) if abs(float(t @ own)) < PARALLEL]
    if not others:
        raise InputError(f"{point.branch}.{point.label}: no second real family crosses here")
    direction = min(others, key=lambda t: abs(float(t @ own)))
    direction = direction if direction[-1] >= 0.0 else -direction
    measured = unstable_count(point), np.asarray(point.eigenvalues, dtype=complex)
    parent = Parent.of(point)
    return [Seed(problem, point.z, direction, None, point.scale, (-1, 1), parent, measured=measured)]


@born(HybridOrbits, "PD", "the orbits of twice the period", explored=CASCADE)
def doubled_orbits(problem: HybridOrbits, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The orbits with twice the events, along the eigenvector of the multiplier -1 and the map's normal form."""
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    predictor = flip_predictor(jet_at(problem.inner, point.z))
    d = np.append(predictor.q, 0.0) / point.scale
    k = 2.0 * np.append(predictor.h2 + predictor.p2 * predictor.hp, predictor.p2) / point.scale
    size = float(np.linalg.norm(d))
    d, k = d / size, k / elementary.square(size)
    multipliers = np.asarray(elementary.square(np.asarray(point.eigenvalues)), dtype=complex)
    return [
        Seed(
            problem.doubled(), point.z, d, k - float(k @ d) * d, point.scale, (1,), Parent.of(point),
            (HALF_PERIOD,), measured=(unstable_count(point), multipliers),
        )
    ]  # fmt: skip
