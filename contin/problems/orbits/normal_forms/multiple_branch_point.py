"""Branch points of orbits at which symmetry makes several multipliers pass 1 together: the families that cross there.

In a ring or an all-to-all network of equal cells the orbit in step loses its stability to several patterns at once. The
equivariant branching lemma (Cicogna 1981; Golubitsky, Stewart and Schaeffer, Singularities and Groups in Bifurcation
Theory II, ch. XIII) gives a family for each vector q of the critical space that is, up to its length, the only one a
symmetry keeps: S q = q, where S may shift the time by half a period.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.equal_multipliers import repeated
from contin.problems.orbits.linearised.bordered import Bordered, Borders, crossing
from contin.problems.orbits.linearised.linear import OrbitLinear, embed
from contin.problems.orbits.linearised.multipliers import nontrivial
from contin.problems.orbits.symmetric.symmetry import moved_direction
from contin.problems.symmetry import every_symmetry

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

CRITICAL: Final = 1e-3  # distance from 1 of the multipliers that pass it together
MOST: Final = 6  # of them
SIMPLE: Final = 1e-2  # distance of two eigenvalues of a symmetry's action from which they are two
OF_FAMILY: Final = "family"  # borders of the equations of a family
SAME: Final = 1e-3  # 1 - cosine up to which two directions are one

Complex = NDArray[np.complex128]


def kernel_dimension(problem: OrbitEquations, eigenvalues: Complex) -> int:
    """Number of multipliers, beside the trivial one, that are 1 at a branch point.

    They may pass so fast that the error of the place leaves them off 1, but alike.
    """
    values = nontrivial(problem, eigenvalues)
    return max(int(np.sum(np.abs(values - 1.0) < CRITICAL)), repeated(values, 1.0) if len(values) else 0)


def crossing_tangents(problem: OrbitEquations, z: Array, scale: Array, eigenvalues: Complex) -> list[Array]:
    """Unit tangents (scaled, like z) of the crossing families, one of those that symmetries map onto each other.

    Empty where no more than one multiplier is 1, or no symmetry tells a direction from the others.
    """
    if not 1 < kernel_dimension(problem, eigenvalues) <= MOST:
        return []
    linear, tangents = OrbitLinear(problem, z, scale, z), []
    for null, left in planes(linear, eigenvalues):
        found = crossing(linear.hessian, null, left)
        if found:
            along = [abs(float(t @ null[:, 0])) for t in found]  # the other one is the family at hand
            tangents.append(embed(linear, found[int(np.argmin(along))]))
    return tangents


def planes(
    linear: OrbitLinear, eigenvalues: Complex, known: dict[str, Borders] | None = None
) -> list[tuple[Array, Array]]:  # fmt: skip
    """For each family that may cross: two null vectors (N, 2), and the left one (rows,) that its equation needs.

    Where several multipliers are 1 the first null vector is that of the family at hand; none where no symmetry tells a
    direction from the others.

    known : borders of the equations on another mesh, with which half the factors do; these add their own.
    """
    count = kernel_dimension(linear.problem, eigenvalues)
    if count > MOST:
        return []
    known = {} if known is None else known
    bordered = Bordered.of(linear.jacobian, max(count, 1) + 1, known.get(OF_FAMILY))
    known[OF_FAMILY] = bordered.b, bordered.c
    right, _, left = bordered.solve()
    null = np.linalg.qr(right)[0]
    if count <= 1:
        return [(null, left[:, 0] / np.linalg.norm(left[:, 0]))]
    actions = _actions(linear, null)
    if not actions:
        return []
    turned = np.linalg.svd(np.vstack([a - np.eye(count + 1) for a in actions]))[2]
    own, others = null @ turned[-1], turned[:-1].T  # all of them keep the family's own direction
    found = []
    for q in _kept([others.T @ a @ others for a in actions]):
        x = null @ others @ q
        dual = left.T @ (linear.hessian(own) @ x)  # the derivative of the critical multipliers acts along q alone
        if np.linalg.norm(dual) > 0.0:
            found.append((np.column_stack([own, x]), left @ dual / np.linalg.norm(dual)))
    return found


def _actions(linear: OrbitLinear, null: Array) -> list[Array]:
    """Matrices (k, k) of symmetries on the null space (N, k), without and with a shift by half a period, where these
    keep the orbit; they may shift the time a little further, too.

    A word is its first letter after the rest, an earlier word; itself it is applied where these do not keep the orbit.
    """
    z, nu = linear.z, linear.nu
    drift = np.append(linear.field.ravel() / linear.units[:nu], [0.0, 0.0])
    onto = np.linalg.pinv(np.column_stack([null, drift / np.linalg.norm(drift)]))
    directions = np.zeros((null.shape[1], z.size))
    directions[:, linear.unknowns] = null.T * linear.units
    found: dict[str, dict[float, Array]] = {}
    for word in every_symmetry(linear.problem):
        first, _, rest = word.partition("*")
        pairs = product(found.get(first, {}).items(), found.get(rest, {}).items())
        found[word] = {(f + g) % 1.0: a @ b for (f, a), (g, b) in pairs}
        for fraction in () if found[word] else (0.0, 0.5):
            images = [moved_direction(linear.problem, z, direction, word, fraction) for direction in directions]
            columns = [
                (onto @ np.append(image.ravel() / linear.units[:nu], column[nu:]))[:-1]
                for image, column in zip(images, null.T, strict=True)
                if image is not None
            ]
            if len(columns) == len(images):
                found[word][fraction] = np.column_stack(columns)
    return [matrix for matrices in found.values() for matrix in matrices.values()]


def _kept(actions: list[Array]) -> list[Array]:
    """Vectors, unique up to their length, that one of the actions keeps; one of those that are images of each other."""
    kept: list[Array] = []
    for action in actions:
        values, vectors = np.linalg.eig(action)
        near = np.flatnonzero(np.abs(values - 1.0) < SIMPLE)
        if len(near) != 1:
            continue
        q = vectors[:, near[0]].real
        q /= np.linalg.norm(q)
        images = [q, *(a @ q for a in actions)]
        if all(abs(float(i @ other)) < (1.0 - SAME) * float(np.linalg.norm(i)) for i in images for other in kept):
            kept.append(q)
    return kept
