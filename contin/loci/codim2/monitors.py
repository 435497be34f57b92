"""Test functions of codimension-two points at one point of a curve, in numpy: what `kernels.locus` computes in a march.

Used where there is no kernel: maps, large systems and user functions. Maps:
    folds and flips   2 quadratic (cubic) coefficient   3 <psi, v>   4 pairs of the other multipliers
                      5 another at -1 (+1)
    Neimark-Sacker    2 cos - 1   3 cos + 1   4 another at +1   5 another at -1   6 l1   7 pairs   8 cos + 1/2   9 cos
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.linalg.spectrum import count_and_tests
from contin.loci.codim2 import degenerate
from contin.loci.codim2.flip_coefficient import flip_coefficient
from contin.loci.codim2.functions import lyapunov
from contin.loci.codim2.matrices import null_pair, own_critical, scaled_matrix
from contin.loci.codim2.uncomputed_tests import untold
from contin.machine import elementary
from contin.normalforms.result import NO_FORM

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

BESIDE_BT = 1e-9  # squared frequency (relative) below which only rounding is left of l1, which grows towards a BT
NOISE = 1e-9  # a relative size below this is a zero that stays: degenerate along the whole curve


def tests_at(problem: CurveOfPoints, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
    """Tests from index 2 on, the number of unstable eigenvalues without the critical ones, and all eigenvalues."""
    matrix = scaled_matrix(problem, z)
    values = np.linalg.eigvals(matrix).astype(complex)
    values = values[np.lexsort((-values.imag, -values.real))]
    others = np.delete(values, own_critical(problem, z, values))
    if problem.system.kind == "map":
        unstable = int(np.sum(np.abs(others) > 1.0))
        return _map_tests(problem, z, matrix, others), unstable, values
    pairs = pair_test(others, False) if len(others) > 1 else 1.0
    unstable = int(np.sum(others.real > 0.0))
    if problem.locus == "HB":
        product = real_test(others, 0.0, float(np.abs(values).max()))
        kappa = problem.curve.scalar(z)
        size = elementary.square(float(np.linalg.norm(matrix)))
        sign = _lyapunov(problem, z) * np.sign(product) if kappa > BESIDE_BT * size else 0.0
        return np.array([kappa / size, product, pairs, sign]), unstable, values
    v, psi = null_pair(matrix, problem.curve.reference(z))
    if problem.locus == "BP":
        return np.array([degenerate.test(problem, z), float(psi @ v), pairs, 1.0]), unstable, values
    return np.array([quadratic(problem, z, v, psi), float(psi @ v), pairs, 1.0]), unstable, values


def _lyapunov(problem: CurveOfPoints, z: Array) -> float:
    """l1; 0, which has no sign, and a remark where it has a pole."""
    try:
        return lyapunov(problem, z)
    except NO_FORM as reason:
        return untold(problem, "GH", z, reason)


def quadratic(problem: CurveOfPoints, z: Array, v: Array, psi: Array) -> float:
    """<psi, B(v, v)> in scaled states, relative to the size of f_u."""
    curve = problem.curve
    wide = np.zeros(problem.n + len(problem.base))
    wide[: problem.n] = v * curve.sizes
    image = curve.system.derivative(z[: problem.n], curve.full_parameters(z), wide, wide) / curve.sizes
    if problem.n == 1 and problem.system.kind != "map":  # f_u is rounding at a fold, no measure of rates
        return float(psi @ image)
    return float(psi @ image) / max(float(np.linalg.norm(scaled_matrix(problem, z))), 1e-300)


def real_test(values: Vector, target: float, size: float = 0.0) -> float:
    """Sign of prod (l - target) over the real ones, with the relative size of the smallest factor; 1 without any.

    size : of the critical eigenvalues, which are not among these.
    """
    if not len(values):
        return 1.0
    size = max(float(np.abs(values).max()), abs(target), size, 1e-300)
    smallest = float(np.abs(values - target).min()) / size
    real = values[values.imag == 0.0].real
    return float((-1.0) ** int(np.sum(real < target))) * (smallest if smallest > NOISE else 0.0)


def pair_test(values: Vector, by_multipliers: bool) -> float:
    """The test of pairs of `kernels.tests_of_stability`, zero where it is only rounding."""
    _, tests = count_and_tests(values, by_multipliers)
    return float(tests[2]) if abs(tests[2]) > NOISE else 0.0


def _map_tests(problem: CurveOfPoints, z: Array, matrix: Array, others: Any) -> Array:
    pairs = pair_test(others, True) if len(others) > 1 else 1.0
    if problem.locus == "NS":
        cosine = problem.curve.scalar(z)
        sign, fold = 0.0, real_test(others, 1.0)
        if abs(cosine) < 1.0:  # d has a pole where another multiplier is 1 (LPNS): no sign changes there
            sign = lyapunov(problem, z, beyond_error=True) * float(np.sign(fold))
        return np.array([
            cosine - 1.0, cosine + 1.0, fold, real_test(others, -1.0), sign, pairs, cosine + 0.5,
            cosine,
        ])  # fmt: skip
    shift = -1.0 if problem.locus == "PD" else 1.0
    v, psi = null_pair(matrix - shift * np.eye(problem.n), problem.curve.reference(z))
    if problem.locus == "LP":
        leading = quadratic(problem, z, v, psi)
    elif problem.locus == "PD":
        # c has a pole where another multiplier is 1 (LPPD), and one at R2: no sign changes there
        leading = flip_coefficient(problem, z) * float(np.sign(psi @ v) * np.sign(real_test(others, 1.0)))
    else:
        leading = degenerate.test(problem, z)
    return np.array([leading, float(psi @ v), pairs, real_test(others, -shift)])
