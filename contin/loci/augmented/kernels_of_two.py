"""Where a kernel of two dimensions is passed on a curve of singular solutions of boundary-value problems.

Other curves of folds or of branch points pass there (two modes of a rod buckle at once), and no label tells of it.
Between two rows det [F_x w; v^T 0] changes its sign, with the null vectors v, w of the first of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.bvp.on_mesh import OnMesh
from contin.linalg.vectors import norm
from contin.loci.augmented.singular import null_vectors, stacked
from contin.loci.augmented.sparse import Factors
from contin.problems.orbits.mesh.layout import trimmed

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.loci.augmented.singular_solutions import SingularSolutions

ALIKE: Final = 0.5  # cosine of null functions of neighbouring rows; below it their senses are not told


def passed(base: SingularSolutions, z: Array) -> Sequence[int]:
    """Rows of z (padded on their left) up to which one was passed."""
    found: list[int] = []
    for k in range(1, len(z)):
        before, after = _matrix(base, z[k - 1], z[k]), _matrix(base, z[k], z[k])
        if before is not None and after is not None and _changes(before, after):
            found.append(k)
    return found


def _changes(before: csc_matrix, after: csc_matrix) -> bool:
    borders = null_vectors(before, 1)
    first, second = (Factors(stacked(m, borders.left[:, None], borders.right)) for m in (before, after))
    if first.sign == 0.0 or second.sign == 0.0:
        return True
    if first.sign * second.sign > 0.0:
        return False
    unit = np.append(np.zeros(len(borders.left)), 1.0)
    v, w = second.solve(unit)[:-1], second.solve_transposed(unit)[:-1]
    alike = min(abs(float(v @ borders.right[:, 0])) / norm(v), abs(float(w @ borders.left)) / norm(w))
    return alike > ALIKE


def _matrix(base: SingularSolutions, z: Array, like: Array) -> csc_matrix | None:
    """F_x at a row z on the mesh of another one; None where it is not finite."""
    profile, mesh = base.profile(z), base.profile(like).h
    u = profile.u if np.array_equal(profile.h, mesh) else profile.on_mesh(mesh).u
    here = OnMesh(base.at(z), mesh).at(np.append(u.ravel(), trimmed(z)[-1]))
    return None if here is None else here.linear.matrix
