"""Null vectors, eigenvectors and solves with singular matrices, indifferent to the units of the states.

Every matrix is first equilibrated: rows and columns are scaled by powers of two (no rounding) until their largest
entries are near one. A state measured in units a million times smaller then changes nothing but its own components.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import frexp, ldexp
from operator import mul

import numpy as np

from contin.abi import Vector
from contin.linalg.dense_pencil import every_of_pencil
from contin.linalg.vectors import norm
from contin.normalforms.jet import Complex, Real

TIE = 1e-6  # components within this of the largest modulus count as equally large: the first of them sets the sign
SINGULAR = 1e-13  # a solution this many times its equation's right side has no digits
RESONANT = "another eigenvalue is in resonance: a coefficient has a pole here"
ORTHOGONAL = 1e-12  # cosine of two null vectors that is zero with rounding errors
FEW = 64  # entries of a matrix that are equilibrated as Python's numbers
MISLED = 1e-6  # of the largest entry: a matrix that makes as much of a unit vector does not take it to zero, ...
CLOSER = 1e-3  # ... where there is one of which it makes this part of it
SWEEPS = 12  # over rows and columns, at most, after which they change no more
UNLINKED = 1e-300  # a coupling this small beside the one back is none: their ratio has no value
REFINED = 2  # times by the two-sided Rayleigh quotient, whose error is cubed each time
NOISE = 1e-10  # entries of a matrix below this fraction of the largest may be rounding errors


@dataclass(frozen=True, eq=False)
class EigenPair:
    """A q = value q, A^H p = conj(value) p, |q| = 1, <p, q> = conj(p) . q = 1, largest component of q positive.

    With a mass matrix A q = value M q, A^H p = conj(value) M^H p, <p, M q> = 1.
    """

    value: complex
    right: Vector
    left: Vector
    singular: float  # smallest singular value of the equilibrated A - value I: zero up to rounding
    gap: float  # the next one: the pair is well defined where gap >> singular


def root_power(x: Real, order: int) -> Real:
    """The power of two nearest, in its exponent, to the root of this even order of each x > 0; exact."""
    mantissa, exponent = np.frexp(x)
    whole = exponent - 1  # x = (2 mantissa) 2^whole, 1 <= 2 mantissa < 2
    tie = np.rint(whole / order).astype(whole.dtype)
    nearest = np.where(mantissa == 0.5, tie, (whole + order // 2) // order)
    return np.asarray(np.ldexp(1.0, nearest))


def equilibrate(matrix: Vector) -> tuple[Real, Real]:
    """Powers of two (r, c) that bring the largest entry of each row and column of diag(r) matrix diag(c) near 1.

    Ruiz, "A scaling algorithm to equilibrate both rows and columns norms in matrices", RAL-TR-2001-034. Zero rows and
    columns keep their scale.
    """
    size = np.abs(matrix)
    if size.size <= FEW and np.isfinite(size).all():
        return _equilibrated(size.tolist())
    r, c = np.ones(matrix.shape[0]), np.ones(matrix.shape[1])
    for _ in range(SWEEPS):
        scaled = r[:, None] * size * c
        rows, columns = scaled.max(axis=1), scaled.max(axis=0)
        both = np.concatenate([rows, columns])
        both[both == 0.0] = 1.0
        step = 1.0 / root_power(both, 2)
        if not np.any(step != 1.0):
            break
        r_step, c_step = step[: len(rows)], step[len(rows) :]
        r, c = r * r_step, c * c_step
    return r, c


def _equilibrated(size: list[list[float]]) -> tuple[Real, Real]:
    """`equilibrate` of a few entries, for which Python's numbers take a fifth of the time; the same powers of two."""
    r, c, across = [1.0] * len(size), [1.0] * len(size[0]), list(zip(*size, strict=True))
    for _ in range(SWEEPS):
        rows = [_half_power(max(map(mul, row, c)) * x) for row, x in zip(size, r, strict=True)]
        columns = [_half_power(max(map(mul, column, r)) * x) for column, x in zip(across, c, strict=True)]
        if all(step == 1.0 for step in (*rows, *columns)):
            break
        r, c = list(map(mul, r, rows)), list(map(mul, c, columns))
    return np.array(r), np.array(c)


def _half_power(x: float) -> float:
    """1 / `root_power`(x, 2), and 1 for 0."""
    if x == 0.0:
        return 1.0
    mantissa, exponent = frexp(x)
    whole = exponent - 1
    return ldexp(1.0, -(round(whole / 2) if mantissa == 0.5 else (whole + 1) // 2))


def normalise(q: Vector) -> Vector:
    """q scaled to |q| = 1 with its component of largest modulus positive (for complex q: real and positive)."""
    largest = np.abs(q).max()
    q = q / largest  # first, so that the 2-norm neither overflows nor underflows
    lead = q[int((np.abs(q) >= 1.0 - TIE).argmax())]
    unit: Vector = q * (np.conj(lead) / np.abs(lead)) / norm(q)
    return unit


def balance(matrix: Vector) -> Real:
    """Powers of two d for which the rows and columns of diag(1/d) matrix diag(d) have off-diagonal parts of like size.

    Parlett and Reinsch, Numer. Math. 13 (1969) 293: a change of the states' units that the matrix itself suggests.
    """
    size = np.abs(matrix) * (1.0 - np.eye(len(matrix)))
    d = np.ones(len(matrix))
    for _ in range(SWEEPS):
        scaled = size * d / d[:, None]
        rows, columns = scaled.sum(axis=1), scaled.sum(axis=0)
        linked = (rows > UNLINKED * columns) & (columns > UNLINKED * rows)
        unbalance = np.where(linked, rows, 1.0) / np.where(linked, columns, 1.0)
        step = root_power(unbalance, 4)
        if np.all(step == 1.0):
            break
        d = d * step
    return d


def singular_vectors(matrix: Vector, dimension: int = 1, scale: Real | None = None) -> tuple[Vector, Vector, Real]:
    """Right and left null vectors (columns of two (n, dimension) arrays) and all singular values, equilibrated.

    The matrix is first measured in the typical sizes of the states, `scale` (n,), where they are known, else in units
    that balance it; then rows and columns are equilibrated, which keeps slow equations beside fast ones. Entries below
    NOISE of the largest do not take part in that: a row of a singular matrix may be nothing but rounding errors. Where
    there are larger errors in such a row (of a mesh), which equilibration would make large, there is none.
    """
    d = balance(matrix) if scale is None else scale
    measured = matrix * d / d[:, None]
    size = np.abs(measured)
    r, c = equilibrate(np.where(size > NOISE * size.max(), size, 0.0))
    u, s, vh = np.linalg.svd(r[:, None] * measured * c)
    order = slice(-1, -dimension - 1, -1)
    missed = _missed(measured, c * vh[-1].conj(), r * u[:, -1])
    if missed > MISLED * size.max() and np.linalg.svd(measured, compute_uv=False)[-1] < CLOSER * missed:
        r, c = np.ones(len(r)), np.ones(len(c))
        u, s, vh = np.linalg.svd(measured)
    return (c * d)[:, None] * vh[order].conj().T, (r / d)[:, None] * u[:, order], s


def _missed(matrix: Vector, right: Vector, left: Vector) -> float:
    """What a matrix makes of vectors that it should take to zero, in their lengths."""
    right, left = right / np.abs(right).max(), left / np.abs(left).max()
    return max(norm(matrix @ right) / norm(right), norm(left.conj() @ matrix) / norm(left))


def null_pair(
    matrix: Vector, value: complex = 0.0, scale: Real | None = None, mass: Real | None = None
) -> EigenPair:
    """Null vectors of a matrix with a simple zero eigenvalue (or eigenvectors of A, given A - value I).

    Raises `ZeroDivisionError` where <p, q> vanishes: a double eigenvalue with one eigenvector (for example BT).
    """
    right, left, s = singular_vectors(matrix, 1, scale)
    q = normalise(right[:, 0])
    p = left[:, 0] / np.abs(left[:, 0]).max()
    moved = q if mass is None else mass @ q
    product = np.vdot(p, moved)
    d = balance(matrix) if scale is None else scale
    length = norm(p * d) * norm(moved / d)
    located = float(s[-1] / s[-2]) if len(s) > 1 and s[-2] > 0.0 else 0.0  # how far the vectors are off
    if not abs(product) > max(ORTHOGONAL, located) * length:
        raise ZeroDivisionError("left and right null vectors are orthogonal: the zero eigenvalue is not simple")
    return EigenPair(value, q, p / np.conj(product), float(s[-1]), float(s[-2]) if len(s) > 1 else np.inf)


def eigen_pair(A: Real, value: complex, mass: Real | None = None) -> EigenPair:
    """Eigenvectors of A to the eigenvalue nearest `value`, which is refined by its two-sided Rayleigh quotient."""
    weights = np.eye(len(A)) if mass is None else mass
    pair = null_pair(A - value * weights, value, mass=mass)
    for _ in range(REFINED):
        value = complex(np.vdot(pair.left, A @ pair.right))
        pair = null_pair(A - value * weights, value, mass=mass)
    return pair


def eigenvalues(A: Real, mass: Real | None = None) -> Complex:
    """All eigenvalues (LAPACK balances the matrix first); the finite ones of a pencil."""
    if mass is not None:
        return np.asarray(every_of_pencil(A, mass)[0])
    values: Complex = np.linalg.eigvals(A).astype(complex)
    return values


def solve(matrix: Vector, rhs: Vector, columns: Vector | None = None, rows: Vector | None = None) -> Vector:
    """x of [[matrix, columns], [rows^H, 0]] [x; s] = [rhs; 0]; without borders, matrix x = rhs.

    With columns = q and rows = p (n, k) of a k-fold zero eigenvalue, this is matrix x = rhs - q <p, rhs> with
    <p, x> = 0. One step of iterative refinement. Cost: one dense LU of n + k.

    LinAlgError where the matrix is singular to rounding: in homological equations, where eigenvalues are resonant.
    """
    return solve_with_growth(matrix, rhs, columns, rows)[0]


def solve_with_growth(
    matrix: Vector, rhs: Vector, columns: Vector | None = None, rows: Vector | None = None
) -> tuple[Vector, float]:
    """See `solve`; and how many times its right side the solution is, in balanced units: large beside a pole."""
    full, right = bordered(matrix, columns, rows), rhs
    if len(full) > len(matrix):
        right = np.concatenate([rhs, np.zeros((len(full) - len(matrix), *rhs.shape[1:]))])
    r, c = equilibrate(full)
    scaled = r[:, None] * full * c
    target = (r * right.T).T
    try:
        x = np.linalg.solve(scaled, target)
    except np.linalg.LinAlgError as error:  # "Singular matrix", which tells users nothing
        raise np.linalg.LinAlgError(RESONANT) from error
    x = x + np.linalg.solve(scaled, target - scaled @ x)
    grown, size = norm(x.ravel()) * float(np.abs(scaled).sum(axis=1).max()), norm(target.ravel())
    if grown * SINGULAR > size:
        raise np.linalg.LinAlgError(RESONANT)
    answer: Vector = (c * x.T).T[: len(matrix)]
    return answer, grown / size if size else 0.0


def bordered(matrix: Vector, columns: Vector | None = None, rows: Vector | None = None) -> Vector:
    """[[matrix, columns], [rows^H, 0]]; the matrix itself without borders."""
    if columns is None or rows is None:
        return matrix
    n, k = columns.shape
    full = np.zeros((n + k, n + k), np.result_type(matrix, columns, rows))
    full[:n, :n], full[:n, n:], full[n:, :n] = matrix, columns, rows.conj().T
    return full
