"""The Jacobian at a point of a curve of special points: scaled, its null vectors, its critical eigenvalues."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contin.abi import Vector
    from contin.loci.curve_of_points import CurveOfPoints


def scaled_matrix(problem: CurveOfPoints, z: Array) -> Array:
    """f_u in units of the states' sizes."""
    d = problem.curve.sizes
    return np.asarray(problem.curve.matrix(z) * d / d[:, None])


def scaled_matrices(problem: CurveOfPoints, z: Array) -> Array:
    """`scaled_matrix` at rows z, (rows, n, n)."""
    curve, n = problem.curve, problem.n
    jacobians = curve.system.jacobians(z[:, :n], parameters_at(problem, z))[1]
    return np.asarray(jacobians[:, :, :n] * curve.sizes / curve.sizes[:, None])


def parameters_at(problem: CurveOfPoints, z: Array) -> Array:
    """All parameters at rows z."""
    places = problem.curve.places
    parameters = np.empty((len(z), len(problem.base)))
    parameters[:] = problem.base
    parameters[:, list(places)] = z[:, -len(places) :]
    return parameters


def null_pair(matrix: Array, reference: Array) -> tuple[Array, Array]:
    """Unit null vectors of a singular matrix: v along `reference`, psi such that adj(matrix) = c v psi^T with c > 0."""
    left, _, right = np.linalg.svd(matrix)
    v, psi = right[-1], left[:, -1]
    if float(v @ reference) < 0.0:
        v = -v
    bordered = np.block([[matrix, psi[:, None]], [v[None, :], np.zeros((1, 1))]])
    return v, psi if np.linalg.slogdet(bordered)[0] < 0.0 else -psi


def eigenvalues(problem: CurveOfPoints, z: Array) -> NDArray[np.complex128]:
    """Eigenvalues of f_u at z by falling real part."""
    d = problem.curve.sizes
    values = np.linalg.eigvals(problem.curve.matrix(z) * d / d[:, None]).astype(complex)
    return values[np.lexsort((-values.imag, -values.real))]


def critical_value(problem: CurveOfPoints) -> float:
    """The critical eigenvalue of the curve: 0, or of maps 1 (LP, BP) and -1 (PD)."""
    if problem.locus == "PD":
        return -1.0
    return 1.0 if problem.system.kind == "map" else 0.0


def own_critical(problem: CurveOfPoints, z: Array, values: Vector) -> list[int]:
    """Indices of the eigenvalues that are critical along the curve."""
    if problem.locus in ("LP", "BP", "PD"):
        return [int(np.argmin(np.abs(values - critical_value(problem))))]
    kappa = problem.curve.scalar(z)
    total, product = (0.0, kappa) if problem.locus == "HB" else (2.0 * kappa, 1.0)
    size = max(float(np.abs(values).max()), 1e-300)
    n = len(values)
    pairs = [(i, j) for i in range(n) for j in range(i + 1, n)]
    gaps = [size * abs(values[i] + values[j] - total) + abs(values[i] * values[j] - product) for i, j in pairs]
    return list(pairs[int(np.argmin(gaps))])
