"""Eigenvalues of a matrix with what their errors are in proportion to, and the tests of stability made of them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.eigen import eigenvalues
from contin.kernels.grading import grade
from contin.kernels.tests_of_stability import flow_tests, map_tests

LARGE: Final = 60  # states, beyond which LAPACK is much faster and its errors are taken


def spectrum(matrix: Array) -> tuple[NDArray[np.complex128], Array]:
    """Eigenvalues by falling real part, and rates (n,), falling: the k-th largest has an error in proportion to them.

    Matrices with rates far apart are brought into graded order first, so that slow eigenvalues keep their digits.
    """
    n = len(matrix)
    rates = np.empty(n)
    if n <= LARGE and np.isfinite(matrix).all():
        ordered = np.array(matrix, dtype=float, order="C")
        if grade(ordered, rates, np.empty((n, n))):
            re, im, unknown = np.empty(n), np.empty(n), np.full(n, np.nan)
            if eigenvalues(ordered, re, im, unknown, unknown) == 0:
                return in_order(re + 1j * im), rates
    values = np.linalg.eigvals(matrix).astype(complex)  # LAPACK balances
    rates[:] = np.abs(values).max(initial=0.0)
    return in_order(values), rates


def noises(values: NDArray[np.complex128], rates: Array) -> Array:
    """The rate that belongs to each eigenvalue, by its rank."""
    ranked = np.empty(len(values))
    ranked[np.argsort(-np.abs(values), kind="stable")] = rates
    return ranked


def count_and_tests(
    values: NDArray[np.complex128], by_multipliers: bool, rates: Array | None = None
) -> tuple[int, Array]:
    """The number of unstable values and the four tests of `kernels.tests_of_stability`."""
    tests = np.zeros(4)
    re, im = np.ascontiguousarray(values.real), np.ascontiguousarray(values.imag)
    if by_multipliers:
        return int(map_tests(re, im, tests)), tests
    if rates is None:
        rates = np.full(len(values), float((np.abs(re) + np.abs(im)).max(initial=0.0)))
    return int(flow_tests(re, im, rates, tests)), tests


def in_order(values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """By falling real part, of a pair the one with positive imaginary part first."""
    return np.asarray(values[np.lexsort((-values.imag, -values.real))])
