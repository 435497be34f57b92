"""The kernel of F_u at a branch point of a boundary-value problem, by inverse iteration without singular values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.bvp.on_mesh import OnMesh
from contin.errors import NotFiniteError

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

MOST_TOLD: Final = 4  # singular values that are looked at: kernels of up to three dimensions
VANISHING: Final = 1e-6  # a singular value below this part of the first that does not vanish is zero
NEARBY: Final = 1e-2  # a singular value below this part of the fourth one belongs to a branch point nearby
LOOSE: Final = 1e-9  # a part of the largest term below which a singular value leaves corrections of rounding only

SmallestValues = tuple[Array, Array]  # singular values of F_u and their right singular vectors as columns


def undetermined(problem: BoundaryEquations, z: Array) -> str:
    """In words, where F_u is singular to about rounding at z: which function the conditions leave free; else empty."""
    mesh = OnMesh(problem, problem.profile(z).h)
    x = mesh.unknowns(z)
    here = mesh.at(x)
    if here is None:
        return ""
    values, vectors = smallest(mesh, x, 1)
    part = float(values[0] / here.linear.magnitude(np.abs(vectors[:, 0])).max())
    if not part < LOOSE:
        return ""
    shape = np.abs(vectors[:, 0].reshape(-1, problem.n)).max(axis=0)
    freest = problem.two.names[int(np.argmax(shape[: problem.two.n_states]))]
    return (
        "The conditions do not determine the solution to more than rounding (smallest singular value "
        f"{part:.0e} of the largest terms): {freest} can be moved almost freely there, as a pulse can on a long "
        "interval. Add a condition that fixes its place, or use its symmetry and half the interval."
    )


def null_vector(mesh: OnMesh, x: Array) -> Array:
    """The right singular vector of F_u at x to its smallest singular value, by inverse iteration; unscaled."""
    return np.asarray(smallest(mesh, x, 1)[1][:, 0])


def smallest(mesh: OnMesh, x: Array, count: int = MOST_TOLD) -> SmallestValues:
    """The smallest singular values of F_u, ascending, and their right singular vectors as columns, unscaled."""
    linear = mesh.linear(x)
    if linear is None:
        raise NotFiniteError("the equations are not finite near this point")
    v = np.linalg.qr(np.random.default_rng(8).normal(size=(mesh.n, count)))[0]
    for _ in range(3):
        w = np.linalg.qr(linear.factor.solve_transposed(v))[0]
        v, grown = np.linalg.qr(linear.factor.solve(w))
    return 1.0 / np.maximum(np.abs(np.diag(grown)), 1e-300), v


def kernel_dimension(small: SmallestValues) -> int:
    """How many singular values of F_u vanish at a branch point, of those that the reduced equation can tell apart.

    Of a kernel of two dimensions one more vanishes, and the equation reduced to one direction has no coefficients.
    """
    values = np.sort(small[0])
    return max(1, int(np.count_nonzero(values[:-1] < VANISHING * values[-1])))


def nearly_null(mesh: OnMesh, x: Array, small: SmallestValues) -> Array:
    """Right singular vectors (n, k) of F_u at x whose singular values are small beside the next one, smallest first."""
    basis = small[1]
    linear = mesh.linear(x)
    assert linear is not None
    _, values, rotation = np.linalg.svd(linear.matrix @ basis, full_matrices=False)
    order = np.argsort(values)
    few = int(np.count_nonzero(values < NEARBY * values.max()))
    return np.asarray(basis @ rotation.T[:, order[: max(1, min(few, MOST_TOLD - 1))]])
