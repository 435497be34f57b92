"""Eigenvalues of a large operator from those of operators nearby, by Davidson's method with an approximate inverse.

Eigenvectors of the last two points span where those of this one are to first order in the step. What is left is told
by corrections, never by how large corrections of other residuals were: a rough residual is made a thousand times
smaller by the inverse, the smooth one that a step along the curve leaves is not.

Ritz values of a symmetric operator are never above its eigenvalues, one by one. Where it is not symmetric, they may be
anywhere between, of vectors that are no eigenvectors at all, so that each of them is asked whether it is one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.linalg.eigen import Spectrum
from contin.linalg.linear import Linear
from contin.linalg.orthonormal import orthonormal, outside
from contin.linalg.ritz import RitzSpace
from contin.linalg.vectors import inner, mixed, norm
from contin.machine import elementary

STEPS: Final = 6.9  # as many steps of a rate of 1/e reduce errors to a thousandth
ACCURACY: Final = 1e-2  # of eigenvectors; eigenvalues of symmetric operators have its square
SIGN: Final = 0.1  # part of a value to which it is known: more than its sign says
ZERO: Final = 1e-9  # part of the largest one followed: what is smaller is zero


def followed(
    linear: Linear, precondition: Callable[[Array], Array], rate: float, vectors: NDArray[np.complex128],
    before: NDArray[np.complex128] | None = None, symmetric: bool = False,
) -> Spectrum | None:  # fmt: skip
    """Rightmost eigenvalues from those of a nearby operator; None where they are not found.

    vectors : (n, k) eigenvectors there, `before` (n, j) those of another point; `precondition` takes columns.
    rate : what part of an error it leaves, so that an error is up to 1/(1 - rate) times its correction.

    Corrections are B r, with the approximate inverse B and the residuals r = A v - l v of Ritz pairs (l, v). Their part
    along v is about 1 - l/m, m the eigenvalue, and about 1 where l is none. Pairs are accepted that need none of more
    than `ACCURACY`, and of more than `SIGN` along themselves (but where l is zero). Those of a symmetric
    operator are asked by the sum of their residuals first: one application of B, in place of k. Cost: k, or 2 k,
    applications of the operator, and as many of B, or one.
    """
    wanted = vectors.shape[1]
    first = orthonormal(_real_rows(vectors))
    space = RitzSpace.of(linear, first)
    if before is not None:
        space.widen(_real_rows(before))
    longer, together = 1.0 / (1.0 - rate), symmetric
    for _ in range(math.ceil(STEPS / abs(elementary.log(rate))) + 1 + together):
        values, ritz = space.rightmost(wanted, symmetric)
        if together:
            asked = space.sum_of_residuals(values, ritz)
            raw = precondition(np.ascontiguousarray(asked.T)).T
            along = np.abs(ritz @ inner(space.basis, np.ascontiguousarray(raw)))
            wrong = float(along[_told(values)].max(initial=0.0))
        else:
            found = _combined(ritz, space.basis)
            parts, of = _residuals(values, ritz, found, space.images)
            raw = precondition(np.column_stack(parts)).T
            wrong = _wrong(values, found, raw, of)
        steps = outside(raw, space.basis)
        if longer * wrong <= SIGN and longer * max(norm(s) for s in steps) < ACCURACY:
            earlier = values  # what the corrections say is still to be had: it makes all values better
            space.widen(steps)
            values, ritz = space.rightmost(wanted, symmetric)
            # the inverse of an earlier point knows nothing of a value that is smaller than what that has moved since
            if np.all(np.abs(values - earlier)[_told(values)] <= SIGN * np.abs(values)[_told(values)]):
                return _nearest_first(values, ritz, space.basis)
            together = False
            continue
        space.widen(steps)
        together = False
    return None


def estimates(linear: Linear, vectors: NDArray[np.complex128]) -> Vector:
    """About the eigenvalues of a symmetric operator, to second order, whose vectors are near the given ones (n, k)."""
    space = RitzSpace.of(linear, orthonormal(_real_rows(vectors)))
    return space.rightmost(vectors.shape[1], symmetric=True)[0]


def improved(
    linear: Linear, precondition: Callable[[Array], Array], rate: float, vectors: NDArray[np.complex128]
) -> Spectrum:
    """Eigenvalues whose vectors lie in a space near the given ones', corrected until these are right to `ACCURACY`."""
    wanted = vectors.shape[1]
    space = RitzSpace.of(linear, orthonormal(_real_rows(vectors)))
    given = len(space.basis)
    values, ritz = space.within(given, wanted)
    for _ in range(math.ceil(STEPS / abs(elementary.log(rate))) + 1):
        parts, _ = _residuals(values, ritz, _combined(ritz, space.basis), space.images)
        steps = outside(precondition(np.column_stack(parts)).T, space.basis)
        if not space.widen(steps):
            break
        earlier = values
        values, ritz = space.within(given, wanted)
        settled = np.abs(values - earlier) <= SIGN * np.abs(values)
        if rate / (1.0 - rate) * max(norm(s) for s in steps) < ACCURACY and np.all(settled[_told(values)]):
            break
    return _nearest_first(values, ritz, space.basis)


def _nearest_first(values: Vector, ritz: Vector, basis: Array) -> Spectrum:
    near = np.argsort(np.abs(values))
    return Spectrum(values[near].astype(complex), _combined(ritz[near], basis).T, False)


def _real_rows(vectors: NDArray[np.complex128]) -> Array:
    """Rows that span the same."""
    real = not np.iscomplexobj(vectors) or not vectors.imag.any()
    return np.ascontiguousarray(vectors.real.T if real else np.vstack([vectors.real.T, vectors.imag.T]))


def _residuals(values: Vector, ritz: Vector, found: Vector, images: Array) -> tuple[list[Array], list[int]]:
    """A v - l v, the real and the imaginary part of one of each pair; and of which vectors they are."""
    parts: list[Array] = []
    one_of_each = np.flatnonzero(values.imag >= 0.0)
    of: list[int] = []
    for k, image in zip(one_of_each.tolist(), _combined(ritz[one_of_each], images), strict=True):
        if values[k].imag > 0.0:
            residual = image - values[k] * found[k]
            parts += [residual.real, residual.imag]
            of += [k, k]
        else:
            parts.append(image.real - values[k].real * found[k].real)
            of.append(k)
    return parts, of


def _told(values: Vector) -> NDArray[np.bool_]:
    """Which values are none of zero, whose vectors are not asked."""
    modulus = np.abs(values)
    return np.asarray(modulus > ZERO * float(modulus.max(initial=0.0)))


def _wrong(values: Vector, found: Vector, corrections: Array, of: list[int]) -> float:
    """The largest part of a correction along its own vector."""
    told, worst = _told(values), 0.0
    for k, correction in zip(of, corrections, strict=True):
        if told[k]:
            worst = max(worst, abs(complex(np.einsum("i,i->", found[k].conj(), correction))))
    return worst


def _combined(weights: Vector, rows: Array) -> Vector:
    """sum_j w_ij rows_j; real where all weights are, which costs half."""
    real = mixed(weights.real, rows)
    if not np.iscomplexobj(weights) or not weights.imag.any():
        return real
    return np.asarray(real + 1j * mixed(weights.imag, rows))
