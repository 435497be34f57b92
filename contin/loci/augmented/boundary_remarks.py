"""What holds all along a curve of folds or branch points of a boundary-value problem, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.position import elsewhere, position
from contin.continuation.problem import Problem
from contin.loci.augmented import kernels_of_two
from contin.loci.tolerances import FORCED_AT_POINTS
from contin.problems.orbits.mesh.layout import trimmed

if TYPE_CHECKING:
    from contin.loci.augmented.singular_solutions import SingularSolutions

UNFORCED: Final = (
    "nothing forces these branch points (no symmetry, invariant subspace or solution that is always there): with two "
    "parameters they are isolated, and the curve is that of the unfolded equations (column `unfolding`)"
)


def remarks_on(base: SingularSolutions, curve: Problem, z: Array) -> list[str]:
    found = []
    if base.extra and len(base.places) == 2 and any(is_unfolded(base, trimmed(row)) for row in z):
        found.append(UNFORCED)
    rows = kernels_of_two.passed(base, z)
    if rows:
        more = elsewhere(len(rows) - 1)
        found.append(
            f"the kernel of the linearised problem has two dimensions near {position(curve, z[rows[0]])}{more}: "
            f"other curves of {base.type} or of branch points pass there; no label tells of it"
        )
    return found


def is_unfolded(base: SingularSolutions, z: Array) -> bool:
    """Whether z is no branch point of the equations themselves: nothing forces it."""
    nodes = base.profile(z).u.size
    here = base.on_mesh(base.profile(z).h, np.ones(nodes + len(base.places))).at(
        np.delete(z[base.where(z)], base.unfolding(z))
    )
    if here is None:
        return False
    terms = abs(here.slope) @ base.node_sizes(z)
    pushed = np.abs(z[-base.behind] * base.borders_at(z, np.ones(z.size)).left)
    return bool(pushed.max() > FORCED_AT_POINTS * terms.max())


