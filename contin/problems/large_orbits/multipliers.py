"""Leading multipliers of an orbit by Arnoldi's method on the action of the monodromy matrix M.

The trivial one is taken out with its direction, v = f(u(0)): the others are those of the quotient, Q M Q with
Q = I - v v^T/|v|^2. Near a fold of cycles, where a second one comes to 1, the error of the discretisation would
otherwise enter by its square root.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits.sweeps import Sweeps

Multipliers = tuple[NDArray[np.complex128], NDArray[np.complex128]]  # and their vectors
DENSE: Final = 40  # unknowns up to which M is formed
FIRST: Final = 6  # multipliers that are asked for at first
INSIDE: Final = 0.9  # the smallest of them must be inside this circle
LONGEST: Final = 60  # vectors without a restart
BEYOND: Final = 3  # vectors from where it has begun, at least
MOST_ROOM: Final = 4  # times the usual number of vectors with restarts
SETTLED: Final = 1e-10  # residual, relative to a multiplier, ...
FAINT: Final = 0.01  # ... or to this part of the largest one, or of 1
REAL: Final = 1e-9  # imaginary part of a real multiplier


def leading(sweeps: Sweeps, velocity: Array) -> Multipliers:
    """All multipliers of modulus above `INSIDE`, and some more, without the trivial one; and their vectors (n, k)."""
    n, size = sweeps.n, norm(velocity)
    v = velocity / size if size > 0.0 else velocity

    def quotient(w: Array) -> Array:
        """Q M Q w, of a vector or of columns."""
        moved = sweeps.monodromy(w - np.multiply.outer(v, v @ w))
        return np.asarray(moved - np.multiply.outer(v, v @ moved))

    if n <= DENSE:
        values, vectors = np.linalg.eig(quotient(np.eye(n)))
        moving = n if sweeps.mass is None else int(np.sum(np.diff(sweeps.mass.indptr) > 0))  # states without mass: 0
        order = np.argsort(-np.abs(values))[: moving - 1]
        return values[order].astype(complex), vectors[:, order].astype(complex)
    start = np.random.default_rng(23).normal(size=n)
    found = _arnoldi(quotient, start) if n > LONGEST else None
    return _restarted(quotient, start) if found is None else found


def _arnoldi(apply: Callable[[Array], Array], start: Array) -> Multipliers | None:
    """Leading eigenvalues and vectors by Arnoldi's method without restarts; None where `LONGEST` vectors do not do.

    When they are found, it begins once more with a vector from outside: other copies of an eigenvalue are not in the
    space of one vector.
    """
    n = len(start)
    basis, H = np.zeros((LONGEST + 1, n)), np.zeros((LONGEST + 1, LONGEST))
    basis[0] = start / norm(start)
    wanted, begun, outside = FIRST, 0, False
    for k in range(LONGEST):
        w = apply(basis[k])
        for _ in range(2):  # orthogonalised twice
            h = np.einsum("ij,j->i", basis[: k + 1], w)
            w = w - np.einsum("i,ij->j", h, basis[: k + 1])
            H[: k + 1, k] += h
        left = norm(w)
        if not np.isfinite(left):
            return None
        values, vectors, whole = _of_hessenberg(H[: k + 1, : k + 1], wanted)
        floor = SETTLED * np.maximum(np.abs(values), FAINT * max(1.0, float(np.abs(values).max(initial=0.0))))
        settled = whole and k - begun >= BEYOND and bool(np.all(left * np.abs(vectors[-1]) <= floor))
        if settled and abs(values[-1]) >= INSIDE:
            wanted, settled = 2 * wanted, False
        if settled and outside:
            return values, np.einsum("ij,ik->jk", basis[: k + 1], vectors)
        if settled or left <= np.finfo(float).tiny:
            w, begun, outside = np.random.default_rng(29 + k).normal(size=n), k + 1, True
            for _ in range(2):
                w = w - np.einsum("i,ij->j", np.einsum("ij,j->i", basis[: k + 1], w), basis[: k + 1])
        else:
            H[k + 1, k] = left
        basis[k + 1] = w / norm(w)
    return None


def _of_hessenberg(H: Array, wanted: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128], bool]:
    """The largest eigenvalues of H, so many or one more for a whole pair, with vectors; whether there are so many."""
    values, vectors = np.linalg.eig(H)
    order = np.argsort(-np.abs(values), kind="stable")
    values, vectors = values[order].astype(complex), vectors[:, order].astype(complex)
    cut = wanted
    if cut < len(values) and values[cut - 1].imag != 0.0 and values[cut] == values[cut - 1].conj():
        pairs_before = int(np.sum(values[:cut].imag > 0.0)) - int(np.sum(values[:cut].imag < 0.0))
        cut += 1 if pairs_before != 0 else 0
    return values[:cut], vectors[:, :cut], len(values) > wanted


def _restarted(apply: Callable[[Array], Array], start: Array) -> Multipliers:
    """The same by Arnoldi's method with restarts; NaN where that does not converge in the largest space either.

    Those that have converged by then need not be the leading ones: none is told apart from them.
    """
    n, wanted, room = len(start), FIRST, 1
    while True:
        count = min(wanted, n - 3)
        vectors_kept = min(n - 1, max(room * (2 * count + 2), 20))
        operator = LinearOperator((n, n), matvec=lambda w: apply(np.asarray(w, dtype=float).ravel()), dtype=float)
        try:
            values, vectors = eigs(operator, k=count, v0=start, tol=1e-10, ncv=vectors_kept)
        except ArpackNoConvergence:
            if room >= MOST_ROOM or vectors_kept == n - 1:
                return np.full(count, np.nan, complex), np.full((n, count), np.nan, complex)
            room *= 2
            continue
        order = np.argsort(-np.abs(values))
        values, vectors = values[order], vectors[:, order]
        if not len(values) or abs(values[-1]) < INSIDE or count == n - 3:
            return values, vectors
        wanted *= 2


def tests_of(values: NDArray[np.complex128]) -> tuple[Array, int]:
    """[NS, PD, BPC], which change sign when a multiplier of their kind crosses, and the number outside the circle."""
    outside = np.abs(values) > 1.0
    pairs = (values.imag > REAL * np.abs(values)) & (values.imag > 0.0)
    real = np.abs(values.imag) <= REAL * np.abs(values)
    tests = []
    for kind in (pairs, real & (values.real < 0.0), real & (values.real > 0.0)):
        gap = float(np.min(np.abs(np.abs(values[kind]) - 1.0), initial=1.0))
        tests.append(-gap if int(np.sum(outside & kind)) % 2 else gap)
    return np.array(tests), int(np.sum(outside))


def critical_index(values: NDArray[np.complex128], type_: str) -> int | None:
    """Index of the multiplier of a type."""
    real = np.abs(values.imag) <= REAL * np.abs(values)
    kind = values.imag > REAL * np.abs(values) if type_ == "NS" else real
    if type_ == "PD":
        kind = kind & (values.real < 0.0)
    elif type_ != "NS":
        kind = kind & (values.real > 0.0)
    found = np.flatnonzero(kind)
    return int(found[int(np.argmin(np.abs(np.abs(values[found]) - 1.0)))]) if found.size else None


def critical_pair(values: NDArray[np.complex128]) -> tuple[int, int] | None:
    """Indices of the two multipliers of a curve of torus bifurcations: complex, or real and of one sign beyond a
    resonance 1:1 or 1:2; those with a product nearest to 1."""
    real = np.abs(values.imag) <= REAL * np.abs(values)
    pairs = []
    for k in np.flatnonzero(~real & (values.imag > 0.0)):
        partner = int(np.argmin(np.abs(values - values[k].conj())))
        pairs.append((int(k), partner))
    for sign in (1.0, -1.0):
        same = np.flatnonzero(real & (sign * values.real > 0.0))
        pairs += [(int(j), int(k)) for i, j in enumerate(same) for k in same[i + 1 :]]
    if not pairs:
        return None
    products = np.array([abs(values[j]) * abs(values[k]) for j, k in pairs])
    return pairs[int(np.argmin(np.abs(products - 1.0)))]


def plane_of(values: NDArray[np.complex128], vectors: NDArray[np.complex128], pair: tuple[int, int]) -> Array:
    """Two real vectors (n, 2) in the plane of a pair."""
    one, other = vectors[:, pair[0]], vectors[:, pair[1]]
    whole = abs(values[pair[0]].imag) > REAL * abs(values[pair[0]])
    return np.column_stack([one.real, one.imag if whole else other.real])


def stay_outside(a: NDArray[np.complex128], b: NDArray[np.complex128]) -> bool:
    """True where, from one orbit to another, every multiplier outside the circle moves by less than its distance."""
    moduli = (np.abs(a), np.abs(b))
    before, after = (np.sort(elementary.log(sizes[sizes > 1.0])) for sizes in moduli)
    return len(before) == len(after) and bool(np.all(np.abs(after - before) < np.minimum(before, after)))
