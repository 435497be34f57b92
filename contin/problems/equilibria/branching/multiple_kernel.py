"""Directions of all branches at a branch point whose kernel has dimension above 1, from the reduced equations."""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.normalforms.directions import branch_directions
from contin.normalforms.jet import DerivativeJet
from contin.normalforms.multiple import CONTINUUM
from contin.problems.equilibria.branching.continuum import branches_of_continuum
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.scaled import ScaledSystem

PARALLEL = 0.9999  # cosine from which a direction is the branch's own


def reduced_branches(local: ScaledSystem, y: Array, own: Array, corank: int) -> list[Outset]:
    """The branches other than the one with tangent `own`."""
    problem, size = local.problem, local.scale[:-1]
    matrix = problem.linear_part(y * local.scale) * size / size[:, None]
    kind = "map" if problem.is_map else "flow"
    jet = DerivativeJet(matrix, lambda d: np.asarray(local.form(y, *d)), 1, kind, np.ones(local.n))  # type: ignore[arg-type]
    known = own if np.any(own) else None
    outsets: list[Outset] = []
    for d in branch_directions(jet, known=known, kernel=corank):
        finer = []
        if d.note == CONTINUUM and corank == 2:
            finer = branches_of_continuum(local, y, 2.0 * float(d.curvature[-1]))
        outsets += finer or [Outset(d.tangent, 2.0 * d.curvature)]
    return [o for o in outsets if known is None or abs(float(o.direction @ own)) < PARALLEL]
