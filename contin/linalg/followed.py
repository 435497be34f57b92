"""Eigenvalues of a large operator from those of operators nearby, by Davidson's method with an approximate inverse.

Eigenvectors of the last two points span where those of this one are to first order in the step. What is left is told
by a correction, never by how large corrections of other residuals were: a rough residual is made a thousand times
smaller by the inverse, the smooth one that a step along the curve leaves is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.linalg.eigen import Spectrum, orthonormal, outside
from contin.linalg.linear import Linear
from contin.linalg.vectors import norm
from contin.machine import elementary

STEPS: Final = 6.9  # as many steps of a rate of 1/e reduce errors to a thousandth
ACCURACY: Final = 1e-2  # of eigenvectors; eigenvalues of symmetric operators have its square
SIGN: Final = 0.1  # part of a real part to which it is known: more than its sign says
ZERO: Final = 1e-9  # part of the largest one followed: what moves by less is on the axis


def followed(
    linear: Linear, precondition: Callable[[Array], Array], rate: float, vectors: NDArray[np.complex128],
    before: NDArray[np.complex128] | None = None, rightmost: bool = True,
) -> Spectrum:  # fmt: skip
    """Rightmost eigenvalues from those of a nearby operator.

    Or, if not `rightmost`, those whose vectors lie in the given ones' space as much as may be.

    vectors : (n, k) eigenvectors there, `before` (n, j) those of another point; `precondition` takes columns.
    rate : what part of an error it leaves, so that an error is up to 1/(1 - rate) times its correction.

    Rightmost ones are corrected by their sum first, with one application of the approximate inverse: where that moves
    nothing by more than its accuracy, it was right; else one by one, until vectors are right to `ACCURACY` and no real
    part moves by more than `SIGN` of itself (or all but nothing). About k applications of the operator, and one or
    1 + k a step of the inverse.
    """
    wanted = vectors.shape[1]
    basis = orthonormal(_real_rows(vectors))
    given = len(basis)
    if before is not None:
        basis = np.vstack([basis, orthonormal(_real_rows(before), basis)])
    images = np.array([linear.apply(v) for v in basis])
    values, ritz = _ritz(basis, images, wanted, given, rightmost)
    longer, together = 1.0 / (1.0 - rate), rightmost
    for _ in range(math.ceil(STEPS / abs(elementary.log(rate))) + 1 + together):
        parts = _residuals(values, ritz, basis, images)
        asked = np.sum(parts, axis=0)[None, :] if together else np.array(parts)
        steps = [outside(step, basis) for step in precondition(np.ascontiguousarray(asked.T)).T]
        worst = longer * max(norm(s) for s in steps)
        if len(basis) + len(steps) > basis.shape[1]:
            break
        fresh = orthonormal(np.array(steps), basis)
        if not len(fresh):
            break
        basis = np.vstack([basis, fresh])
        images = np.vstack([images, [linear.apply(v) for v in fresh]])
        old = values
        values, ritz = _ritz(basis, images, wanted, given, rightmost)
        left = 1.0 if together else rate  # of errors of vectors, and so of values where A is not symmetric
        enough = np.maximum(SIGN * np.abs(values.real), ZERO * float(np.abs(values).max()))
        told = not rightmost or bool(np.all(longer * left * np.abs(values - old) <= enough))
        if left * worst < ACCURACY and told:
            break
        together = False
    near = np.argsort(np.abs(values))
    right = np.array([_combined(ritz[k], basis) for k in near])
    return Spectrum(values[near].astype(complex), right.T.astype(complex), False)


def _real_rows(vectors: NDArray[np.complex128]) -> Array:
    """Rows that span the same."""
    real = not vectors.imag.any()
    return np.ascontiguousarray(vectors.real.T if real else np.vstack([vectors.real.T, vectors.imag.T]))


def _ritz(basis: Array, images: Array, wanted: int, given: int, rightmost: bool) -> tuple[Vector, Vector]:
    """Ritz values (wanted,) and their weights (wanted, len(basis))."""
    values, ritz = np.linalg.eig(np.einsum("in,jn->ij", basis, images))
    part = -values.real if rightmost else -np.linalg.norm(ritz[:given], axis=0)
    order = np.argsort(part, kind="stable")[:wanted]
    return values[order], ritz[:, order].T


def _residuals(values: Vector, ritz: Vector, basis: Array, images: Array) -> list[Array]:
    """A v - l v, the real and the imaginary part of one of each pair."""
    parts: list[Array] = []
    for k in np.flatnonzero(values.imag >= 0.0):
        residual = _combined(ritz[k], images) - values[k] * _combined(ritz[k], basis)
        parts += [residual.real, residual.imag] if values[k].imag > 0.0 else [residual.real]
    return parts


def _combined(weights: Vector, rows: Array) -> Vector:
    """sum w_i rows_i; real weights cost half."""
    if not np.iscomplexobj(weights) or not weights.imag.any():
        return np.asarray(np.einsum("i,ij->j", weights.real, rows))
    return np.asarray(np.einsum("i,ij->j", weights.real, rows) + 1j * np.einsum("i,ij->j", weights.imag, rows))
