"""What symmetries do to the eigenvectors that cross together at a Hopf point.

Symmetries that keep the equilibrium act on the eigenspace E of i omega. They make its dimension what it is where E is
irreducible over the complex numbers (generic Hopf points of equivariant systems: Golubitsky, Stewart and Schaeffer,
Singularities and Groups in Bifurcation Theory II, ch. XVI), and then no matrix commutes
with them but multiples of the identity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array, Vector
from contin.normalforms.jet import Jet, mass_of
from contin.problems.symmetry import apply_symmetry, every_symmetry

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

STEP = 1e-6  # of the difference quotient that makes a matrix of a symmetry, relative to the states' sizes
KEPT = 1e-8  # ... and distance of the equilibrium from its image up to which the symmetry keeps it
COMMUTES = (
    1e-6  # singular values of the commutators up to which a matrix commutes: matrices of symmetries are good to 1e-9
)


@dataclass(frozen=True, eq=False)
class CriticalActions:
    """A basis (n, k) of E, covectors (n, k) with covectors^H M basis = 1, and a matrix (k, k) for every symmetry."""

    basis: Vector
    dual: Vector
    matrices: tuple[Vector, ...]

    @property
    def irreducible(self) -> bool:
        """Whether they force all the eigenvalues to cross together."""
        k = self.basis.shape[1]
        one = np.eye(k)
        rows = [np.kron(m, one) - np.kron(one, m.T) for m in self.matrices]
        sizes = np.linalg.svd(np.vstack(rows), compute_uv=False) if rows else np.zeros(k * k)
        return int(np.sum(sizes < COMMUTES * len(rows))) == 1


def critical_actions(
    equilibria: AlgebraicEquations, z: Array, sizes: Array, jet: Jet, omega: float, count: int
) -> CriticalActions:
    """Of `count` pairs +- i omega at z, with states measured in `sizes` (n,)."""
    mass = mass_of(jet)
    weights = np.eye(jet.n) if mass is None else mass
    matrix = jet.A - 1j * omega * weights
    left, _, right = np.linalg.svd(matrix * sizes[None, :] / sizes[:, None])
    basis = sizes[:, None] * right[-count:].conj().T
    outer = left[:, -count:] / sizes[:, None]
    dual = outer @ np.linalg.inv(basis.conj().T @ weights.T @ outer)
    projection = dual.conj().T @ weights
    return CriticalActions(basis, dual, tuple(projection @ m @ basis for m in _matrices(equilibria, z, sizes)))


def _matrices(equilibria: AlgebraicEquations, z: Array, sizes: Array) -> list[Array]:
    """Of the symmetries that keep the equilibrium."""
    n = len(z) - 1
    rows = np.vstack([z, z + np.hstack([STEP * np.diag(sizes), np.zeros((n, 1))])])
    matrices = []
    for name in every_symmetry(equilibria):
        images = apply_symmetry(equilibria, name, rows)[:, :-1]
        if float(np.max(np.abs(images[0] - z[:-1]) / sizes)) < KEPT:
            matrices.append((images[1:] - images[0]).T / (STEP * sizes[None, :]))
    return matrices
