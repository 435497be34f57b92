"""The family that crosses a family of orbits found by shooting, at a branch point."""

from __future__ import annotations

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.problems.shooting.crossing import crossing, image_of
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.transitions.orbit_BPC_to_crossing import CROSSING
from contin.transitions.orbits_at_point import along_own_parameter, unstable_count
from contin.transitions.registry import born


@born(ShootingProblem, "BPC", "the family that crosses", explored=CROSSING)
def crossing_by_shooting(problem: ShootingProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the family that crosses, along its own parameter."""
    along_own_parameter(problem, point, parameter)
    raw = np.where(point.tangent == 0.0, 0.0, point.tangent / point.scale)
    own = raw / np.linalg.norm(raw)
    found = crossing(problem, point.z, own, point.scale, 1)
    if found is None:
        raise InputError(f"{point.branch}.{point.label}: no second real family was found nearby")
    other = crossing(problem, point.z, own, point.scale, -1)
    alike = other is None or image_of(problem, found.orbit, other.orbit) is not None
    arms = (1,) if alike else (-1, 1)
    beside = {1: found.orbit} if other is None or alike else {1: found.orbit, -1: other.orbit}
    seed = Seed(
        found.problem, point.z, found.direction, found.curvature if alike else None, point.scale, arms,
        Parent.of(point), beside=beside, measured=(unstable_count(point), point.eigenvalues),
    )  # fmt: skip
    return [seed]
