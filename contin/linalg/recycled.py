"""Krylov spaces that serve again: an approximate inverse made of what GMRES has learnt of operators nearby.

A solve leaves directions U and their images C = A U, orthonormal. Then r -> U C^T r + B (r - C C^T r) is A^-1 on the
images, and elsewhere the approximate inverse B that was known before: a chain of such blocks, the identity at its end.
Where A is the identity but for few directions (I - M of a system that dissipates), the operator of the next point
needs an iteration a digit or fewer (Parks, de Sturler, Mackey, Johnson and Maiti, SIAM J. Sci. Comput. 28 (2006)
1651, in the form of a preconditioner: operators that have changed make it worse, never wrong).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array, Vector

MOST: Final = 60  # directions that are kept
SINGULAR: Final = 1e-4  # of the longest: images that are shorter count as so long, for another operator's are not such


@dataclass(eq=False)
class Recycled:
    """Blocks (U, C), each (directions, unknowns), the latest last."""

    blocks: list[tuple[Array, Array]] = field(default_factory=list)

    def copy(self) -> Recycled:
        """What is known now, which learns for itself."""
        return Recycled(list(self.blocks))

    def precondition(self, r: Vector) -> Vector:
        """About A^-1 r."""
        left, out = r, np.zeros_like(r)
        for directions, images in reversed(self.blocks):
            parts = np.einsum("ij,j->i", images, left)
            out = out + np.einsum("i,ij->j", parts, directions)
            left = left - np.einsum("i,ij->j", parts, images)
        return out + left

    def learn(self, directions: Array, basis: Array, hessenberg: Array) -> None:
        """From a solve: A directions^T = basis^T hessenberg; directions (k, n), basis (k + 1, n), (k + 1, k)."""
        if not np.all(np.isfinite(hessenberg)):
            return
        left, sizes, right = np.linalg.svd(hessenberg, full_matrices=False)
        lengths = np.maximum(sizes, SINGULAR * sizes[0])
        if sum(len(u) for u, _ in self.blocks) + len(directions) > MOST:
            self.blocks.clear()
        self.blocks.append(((right / lengths[:, None]) @ directions, left.T @ basis))
