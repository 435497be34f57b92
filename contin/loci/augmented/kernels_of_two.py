"""Where a kernel of two dimensions is passed on a curve of singular solutions of boundary-value problems.

Other curves of folds or of branch points pass there (two modes of a rod buckle at once), and no label tells of it.
Between two rows det [F_x w; v^T 0] changes its sign, with the null vectors v, w of the first of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.loci.augmented.singular import Borders, Matrix, null_vectors
from contin.loci.augmented.sparse import Factors

if TYPE_CHECKING:
    from contin.loci.augmented.singular_solutions import SingularSolutions

ALIKE: Final = 0.5  # cosine of null functions of neighbouring rows; below it their senses are not told


@dataclass(frozen=True, eq=False)
class _Row:
    """Null vectors of F_x, and the sign of its determinant with them as borders."""

    borders: Borders
    sign: float


def passed(base: SingularSolutions, z: Array) -> Sequence[int]:
    """Rows of z (padded on their left) up to which one was passed. One factorisation a row, three on a new mesh."""
    found: list[int] = []
    last: _Row | None = None
    for k in range(1, len(z)):
        same = np.array_equal(base.profile(z[k - 1]).h, base.profile(z[k]).h)
        before, after = last if same else None, _matrix(base, z[k], z[k])
        before = _row(_matrix(base, z[k - 1], z[k])) if before is None else before
        changed, last = (False, None) if before is None or after is None else _change(before, after)
        if changed:
            found.append(k)
    return found


def _row(matrix: Matrix | None) -> _Row | None:
    if matrix is None:
        return None
    borders = null_vectors(matrix, 1)
    return _Row(borders, Factors(matrix.bordered(borders.left[:, None], borders.right)).sign)


def _change(before: _Row, after: Matrix) -> tuple[bool, _Row | None]:
    """Whether the sign changes, and the second row with null vectors of the same sense; None where these are unlike."""
    borders = before.borders
    factors = Factors(after.bordered(borders.left[:, None], borders.right))
    if before.sign == 0.0 or factors.sign == 0.0:
        return True, None
    unit = np.append(np.zeros(len(borders.left)), 1.0)
    v, w = factors.solve(unit)[:-1], factors.solve_transposed(unit)[:-1]
    v, w = v / norm(v), w / norm(w)
    along, across = float(v @ borders.right[:, 0]), float(w @ borders.left)
    if not min(abs(along), abs(across)) > ALIKE:
        return False, None
    turned = Borders(np.copysign(1.0, across) * w, np.copysign(1.0, along) * v[:, None])
    return factors.sign * before.sign < 0.0, _Row(turned, factors.sign)


def _matrix(base: SingularSolutions, z: Array, like: Array) -> Matrix | None:
    """F_x at a row z on the mesh of another one; None where it is not finite."""
    profile, mesh = base.profile(z), base.profile(like).h
    u = profile.u if np.array_equal(profile.h, mesh) else profile.on_mesh(mesh).u
    y = np.append(u.ravel(), base.values(z)[::-1])
    here = base.on_mesh(mesh, np.ones(len(y))).at(y)
    return None if here is None else here.critical(False)
