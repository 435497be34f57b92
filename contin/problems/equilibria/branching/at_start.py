"""A start at a branch point at which the leading terms tell no branch: one of those that pass there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.problems.equilibria.branching.degenerate import fan_at

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations


def unfolded(
    problem: AlgebraicEquations, z: Array, frame: Frame
) -> tuple[Sample, Verified, Mapping[int, Array]] | None:
    """The start with the tangent of a branch, its label, and by arm a point on that; None where there is none.

    Of several branches it is one that goes on on both sides, if there is one, and along which the parameter moves most.
    """
    tangent = np.eye(len(z))[-1]
    near = Sample(z, tangent, np.full(4, np.nan), 0, np.empty(0, complex))
    point = next((p for p in problem.verify_compound(near, near, frame) if isinstance(p, Verified)), None)
    if point is None or point.type != "BP":
        return None
    found = fan_at(problem, point.z, frame.scale, int(point.vectors.get("kernel", 1)))
    if found is None or not found.curves:
        return None
    curve = max(found.curves, key=lambda c: (len(c), abs(float(c[0].direction[-1]))))
    outset = found.outset(curve)
    beside = {arm: at * frame.scale for arm, at in outset.beside.items()}
    start = Sample(point.z, outset.direction, np.full(4, np.nan), point.unstable, point.eigenvalues)
    return start, point, beside
