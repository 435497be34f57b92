"""Further copies of multiple eigenvalues, which a Krylov space from one vector does not hold.

An eigenvalue of multiplicity m has one direction in the Krylov space of any vector. So, after Arnoldi's method has
found eigenvalues, it is run again from a random vector orthogonal to their vectors, with these projected out (locking:
Saad, Numerical Methods for Large Eigenvalue Problems, 2nd ed., sec. 6.2.3), until nothing as near to zero is left.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.dense_pencil import every_of_pencil
from contin.linalg.eigen import CONVERGED, SOLVED, Inverse, Spectrum
from contin.linalg.linear import Linear
from contin.linalg.orthonormal import INDEPENDENT, orthonormal, outside
from contin.linalg.vectors import norm

ROUNDS: Final = 64  # as many copies are looked for
STEPS: Final = 24  # of Arnoldi's method for each; by then the nearest one has converged, or there is none
ENOUGH: Final = 8  # ... after which a nearest one beyond the reach is believed
SLACK: Final = 1.0 + 1e-3
ROUNDED: Final = 1e-5  # of a value: imaginary parts that rounding makes of several equal real ones
ROUNDINGS: Final = 1e3  # rounding errors of the matrix: as large an imaginary part says nothing
EPSILON: Final = float(np.finfo(float).eps)
INVERSE_STEPS: Final = 3  # each gains as many digits as the kernel's eigenvalues are smaller than the others
SMALL: Final = 60  # unknowns of which all eigenvalues are computed


def with_copies(linear: Inverse, n: int, found: Spectrum, reach: float) -> Spectrum:
    """The spectrum with all further eigenvalues of modulus up to `reach`. Costs at least `ENOUGH` solves."""
    basis = orthonormal(np.vstack([found.vectors.real.T, found.vectors.imag.T]))
    images: Array | None = None
    for attempt in range(ROUNDS):
        x = _nearest(linear, n, basis, reach, attempt)
        if x is None:
            break
        if images is None:
            images = np.array([linear.solve(v) for v in basis]).reshape(len(basis), n)  # there may be none
        fresh = orthonormal(x, basis)
        if not len(fresh):
            break
        basis = np.vstack([basis, fresh])
        images = np.vstack([images, [linear.solve(v) for v in fresh]])
    if images is None or not np.all(np.isfinite(images)):
        return _split(found.values, found.vectors, found.certain, rounding_of(linear, n))
    theta, ritz = np.linalg.eig(basis @ images.T)
    order = np.argsort(-np.abs(theta))
    return _split(1.0 / theta[order], basis.T @ ritz[:, order], found.certain, rounding_of(linear, n))


def kernel(linear: Linear, near: Array) -> Array:
    """An orthonormal basis (n, k) of the k directions that A^-1 stretches most, from vectors (n, k) near them.

    Eigenvectors of equal eigenvalues may be almost the same vector; what A^-1 makes of a space is all of the kernel.
    """
    count, random = near.shape[1], np.random.default_rng(17)
    basis = np.linalg.qr(near / norm(near.ravel()) + random.normal(size=near.shape) / np.sqrt(near.size))[0].T
    for _ in range(INVERSE_STEPS):
        image = np.array([linear.solve(v) for v in basis])
        fresh = orthonormal(image) if np.all(np.isfinite(image)) else image[:0]
        if len(fresh) < count:  # A is singular to the last digit
            return near
        basis = fresh
    return basis.T.copy()


def every(matrix: Array, mass: Array | None = None) -> Spectrum:
    """All eigenvalues of a small matrix (finite ones of a pencil), nearest to zero first."""
    if mass is not None:
        rounding = EPSILON * float(np.abs(matrix).sum() / np.abs(mass).sum())
        return _split(*every_of_pencil(matrix, mass), True, rounding)
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(np.abs(values))
    return _split(values[order], vectors[:, order], True, EPSILON * float(np.abs(matrix).sum(axis=1).max()))


def rounding_of(linear: Inverse, n: int) -> float:
    """What rounding errors of the matrix make of a well-conditioned eigenvalue: eps |A|."""
    return EPSILON * float(np.max(linear.magnitude(np.ones(n))))


def _split(values: Vector, vectors: Vector, certain: bool, rounding: float) -> Spectrum:
    """Pairs that rounding made of a double real eigenvalue are real again."""
    values, vectors = values.astype(complex), vectors.astype(complex)
    pairs = (values.imag > 0.0) & (values.imag <= np.maximum(ROUNDED * np.abs(values), ROUNDINGS * rounding))
    for k in np.flatnonzero(pairs).tolist():
        below = np.flatnonzero(values.imag < 0.0)
        if not below.size:
            continue
        other = int(below[np.argmin(np.abs(values[below] - np.conj(values[k])))])
        v = vectors[:, k].copy()  # its column is written before its imaginary part is read
        values[k] = values[other] = values[k].real
        vectors[:, k], vectors[:, other] = v.real, v.imag
    return Spectrum(values, vectors, certain)


def _nearest(linear: Inverse, n: int, basis: Array, reach: float, seed: int) -> Array | None:
    """Real and imaginary part (rows) of the vector to the eigenvalue nearest to zero outside a space, up to `reach`."""
    most = min(STEPS, n - len(basis))
    if most < 1:
        return None
    v = linear.weigh(np.random.default_rng(100 + seed).normal(size=n))
    whole, v = norm(v), outside(v, basis)
    if not norm(v) > INDEPENDENT * whole:
        return None
    space, h = [v / norm(v)], np.zeros((most + 1, most))
    for k in range(most):
        w = outside(linear.solve(space[k], SOLVED), basis)
        if not np.all(np.isfinite(w)):
            return None
        block = np.array(space)
        for _ in range(2):
            c = np.einsum("ij,j->i", block, w)
            w = w - np.einsum("i,ij->j", c, block)
            h[: k + 1, k] += c
        h[k + 1, k] = norm(w)
        theta, ritz = np.linalg.eig(h[: k + 1, : k + 1])
        first = int(np.argmax(np.abs(theta)))
        size = float(np.abs(theta[first]))
        converged = abs(h[k + 1, k] * ritz[-1, first]) <= CONVERGED * size
        ended = k + 1 == most or h[k + 1, k] <= 1e-14 * size
        if converged or ended:
            if not size * reach * SLACK >= 1.0:
                return None
            x = block.T @ ritz[:, first]
            return np.array([x.real, x.imag])
        if k + 1 >= ENOUGH and size * reach < 0.5:
            return None
        space.append(w / h[k + 1, k])
    return None
