"""What is born on families of orbits with jumps: at fixed points of their map, as orbits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.halting import HALF_PERIOD
from contin.machine import elementary
from contin.normalforms.maps import flip_predictor
from contin.problems.describe import jet_at
from contin.problems.equilibrium import EquilibriumProblem
from contin.problems.hybrid.problem import HybridOrbits
from contin.transitions import births
from contin.transitions.orbit_BPC_to_crossing import CROSSING
from contin.transitions.orbit_PD_to_doubled import CASCADE
from contin.transitions.orbits_at_point import unstable_count
from contin.transitions.registry import born


@born(HybridOrbits, "BPC", "the family that crosses", explored=CROSSING)
def crossing_family(problem: HybridOrbits, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the branches of fixed points that cross, as orbits."""
    seeds = births.switch(problem.inner, problem.at_map(point), parameter)
    return [
        replace(seed, problem=replace(problem, inner=seed.problem))
        for seed in seeds
        if isinstance(seed.problem, EquilibriumProblem)
    ]


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
            problem.doubled(), point.z, d, k - float(k @ d) * d, point.scale, (1,), Parent(point.branch, point.label),
            (HALF_PERIOD,), measured=(unstable_count(point), multipliers),
        )
    ]  # fmt: skip
