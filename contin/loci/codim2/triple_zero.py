"""TZ: a point of a curve where two more eigenvalues vanish, more than a point of codimension two can explain.

Symmetry makes it appear in two parameters: where a fold of the symmetric states meets a branch point that breaks the
symmetry, and a further eigenvalue goes along. Curves of several types end or cross there, and their own defining
systems are singular, so it is located by symmetric functions of the three smallest eigenvalues, one of which is 0: of
the others, a b or a + b. Rounding moves each of three that vanish together by its cube root, but not these functions,
and which of the three is the curve's own need not be told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.loci.codim2.matrices import eigenvalues, scaled_matrix
from contin.loci.codim2.solving import RESIDUAL_LIMIT, solve

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

VANISHING = 1e-4  # relative size of eigenvalues that vanish together: the root (or cube root) of rounding
APART = 1e-3  # scaled distance from where it was suspected


def triple_zero(problem: CurveOfPoints, near: Sample, frame: Frame) -> Verified | None:
    """The point near a sample of a curve of folds or branch points of a flow; None where there is none."""
    if problem.locus not in ("LP", "BP") or problem.system.kind == "map" or problem.n < 3:
        return None
    if not _vanish(problem, near.z, 100.0 * VANISHING):
        return None
    found = []
    for function in (lambda z: _products(problem, z), lambda z: float(_smallest(problem, z).sum().real)):
        solved = solve(problem, function, near, frame.scale, turning=True)
        if solved is None or not solved.residual <= RESIDUAL_LIMIT:
            continue
        z = solved.y * frame.scale
        moved = np.linalg.norm(((z - near.z) / frame.scale)[problem.identifying])
        if moved <= APART and _vanish(problem, z, VANISHING):
            values = eigenvalues(problem, z)
            unstable = int(np.sum(values[np.argsort(np.abs(values))[3:]].real > 0.0))
            error = solved.error + float(np.abs(_smallest(problem, z)).max())
            found.append(Verified("TZ", z, solved.residual, error * float(frame.scale[-1]), values, unstable))
    return min(found, key=lambda point: point.error) if found else None


def _products(problem: CurveOfPoints, z: Array) -> float:
    """Sum of the products of two of the three smallest eigenvalues."""
    a, b, c = _smallest(problem, z)
    return float((a * b + b * c + c * a).real)


def _smallest(problem: CurveOfPoints, z: Array) -> Vector:
    """The three smallest eigenvalues, relative to the rates.

    For n = 3, where all eigenvalues vanish, these are the size of f_u, which does not.
    """
    matrix = scaled_matrix(problem, z)
    values = np.linalg.eigvals(matrix).astype(complex)
    size = float(np.linalg.norm(matrix))
    if len(values) > 3:  # in skew coordinates the norm is no measure of rates
        size = min(size, float(np.abs(values).max()))
    return values[np.argsort(np.abs(values))[:3]] / max(size, 1e-300)


def _vanish(problem: CurveOfPoints, z: Array, limit: float) -> bool:
    return bool(np.abs(_smallest(problem, z)).max() <= limit)
