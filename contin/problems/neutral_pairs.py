"""Eigenvalues in pairs whose sum is zero (maps: whose product is one) all along a branch, as in conservative systems.

Where energy, an area or a reversal of time is kept, l and -l (m and 1/m) are eigenvalues together: a pair stays on the
stability boundary until it meets another one, and the sign of its real part is a rounding error. How large those are
depends on the matrix: with right and left eigenvectors q, p an error E of its entries moves l by |p|^T E |q| / |<p, q>|
(Wilkinson, The Algebraic Eigenvalue Problem, ch. 2). Two eigenvalues that are a pair to these errors are made an exact
one before they are counted and tested.
"""

from __future__ import annotations

from cmath import isfinite
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.balancing import balancing_scales
from contin.linalg.spectrum import count_and_tests, spectrum
from contin.model.kept import kept_with
from contin.problems.dense_march import DenseMarch

if TYPE_CHECKING:
    from contin.continuation.sample import Sample
    from contin.problems.contracts import DenseInOneParameter
    from contin.problems.equilibria.equations import AlgebraicEquations
    from contin.problems.orbits.family import FamilyOfOrbits

Values = NDArray[np.complex128]

FEW: Final = 8  # eigenvalues
REMEMBERED: Final = 8  # places
SUSPECT: Final = 1e-6  # of their sizes: two eigenvalues this nearly opposite may be a pair
KNOWN: Final = 1e-14  # ... and this nearly, they are one in the compiled tests as well
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)  # error of an entry beside the row's and column's size
SAFETY: Final = 10.0
STEP: Final = 1e-7  # (relative to the states' and parameter's scales) of the second difference that measures rounding
BESIDE: Final = 1e-4  # (so too) how far from a row the Jacobian of the compiled march's eigenvalues may be
CLEAR: Final = 0.5  # part of what the compiled tests allow for that an error may be
ON_CIRCLE: Final = 1e-7  # distance from the unit circle of a multiplier of an orbit that is on it, to its error
NEARLY: Final = 0.05  # ... and of one whose error is not known
LOOKS: Final = 5  # rows of a branch at which pairs are looked for
ENOUGH: Final = 3  # ... that have them make a part of a branch


def misfits(values: Values, by_multipliers: bool) -> Array:
    """|l_i + l_j| or |m_i m_j - 1|, (n, n), relative to their sizes; infinite on the diagonal."""
    if by_multipliers:
        found = np.abs(values[:, None] * values - 1.0) / (1.0 + np.abs(values[:, None] * values))
    else:
        size = np.abs(values)
        found = np.abs(values[:, None] + values) / np.maximum(size[:, None] + size, 1e-300)
    np.fill_diagonal(found, np.inf)
    return np.asarray(found)


def is_suspect(values: Values, by_multipliers: bool) -> bool:
    """True where two eigenvalues are so nearly a pair that only their errors tell whether they are one."""
    if len(values) > FEW:
        return bool(np.all(np.isfinite(values)) and np.any(misfits(values, by_multipliers) < SUSPECT))
    listed = values.tolist()  # asked at every point that is looked at: numbers take less time than arrays
    if not all(map(isfinite, listed)):
        return False
    if by_multipliers:
        return any(abs(a * b - 1.0) < SUSPECT * (1.0 + abs(a * b)) for a, b in combinations(listed, 2))
    return any(abs(a + b) < SUSPECT * max(abs(a) + abs(b), 1e-300) for a, b in combinations(listed, 2))


def errors_of(problem: DenseInOneParameter, z: Array, values: Values, scale: Array) -> Array:
    """Errors of the eigenvalues of f_u at z, (n,).

    Of rounding in the formulas and in the eigenvalues themselves, and of what f_u changes by on the way to the solution
    next to z: Newton's method leaves a distance of |J^-1 f|.
    """
    shift = STEP * scale * _alternating(len(z))
    step = _to_solution(*problem.linearise(z), scale)
    matrix, after, before, there = problem.linear_parts(np.array([z, z + shift, z - shift, z + step]))
    rounding = np.abs(after - 2.0 * matrix + before) + np.abs(there - matrix)
    balanced = scale[:-1] / scale[0]
    if np.all(np.isfinite(matrix)):
        # as QR does, whose errors are meant
        balanced = balanced * balancing_scales(matrix / balanced[:, None] * balanced)
    entries = rounding / balanced[:, None] * balanced
    matrix = matrix / balanced[:, None] * balanced
    entries += ROUNDING * float(np.abs(matrix).max())
    if not np.all(np.isfinite(entries)):
        return np.zeros(len(values))
    known, right = np.linalg.eig(matrix)
    left = _left_vectors(right)
    products = np.abs(np.sum(left.conj() * right, axis=0))
    size = np.sum(np.abs(left) * (entries @ np.abs(right)), axis=0)
    worst = np.sqrt(np.abs(entries).max() * max(float(np.abs(known).max()), 1e-300))  # a double eigenvalue splits so
    each = np.where(products > 0.0, np.minimum(size / np.maximum(products, 1e-300), worst), worst)
    nearest = np.abs(values[:, None] - known).argmin(axis=1)
    return np.asarray(SAFETY * each[nearest])


def _alternating(size: int) -> Array:
    """1, -1, 1, ...: a direction that no structure of the equations prefers."""
    return np.where(np.arange(size) % 2, -1.0, 1.0)


def _to_solution(f: Array, jacobian: Array, scale: Array) -> Array:
    """The shortest Newton step to the curve, (n + 1,), from F and its Jacobian; zero where there is none."""
    rows = np.abs(jacobian * scale).max(axis=1)
    if not (np.all(np.isfinite(f)) and np.all(np.isfinite(rows)) and np.all(rows > 0.0)):
        return np.zeros(len(scale))
    return np.asarray(scale * np.linalg.lstsq(jacobian * scale / rows[:, None], -f / rows, rcond=None)[0])


def _left_vectors(right: Values) -> Values:
    """Unit left eigenvectors, in columns, to right ones: the rows of the inverse; zero where there is none."""
    try:
        left = np.linalg.inv(right).conj().T
    except np.linalg.LinAlgError:  # a multiple eigenvalue with too few vectors
        return np.zeros_like(right)
    left = left / np.abs(left).max(axis=0)  # of a nearly multiple eigenvalue they are so long that squares overflow
    return np.asarray(left / np.linalg.norm(left, axis=0))


def paired(values: Values, errors: Array, by_multipliers: bool) -> Values:
    """The eigenvalues with those that are pairs to their errors made exact ones; each takes part in one pair."""
    exact = values.copy()
    for i, j in _close(values, errors, by_multipliers):
        a, b = values[i], values[j]
        if by_multipliers:
            root = np.sqrt(a * b)
            exact[i], exact[j] = a / root, b / root
        else:
            exact[i], exact[j] = 0.5 * (a - b), 0.5 * (b - a)
    return exact


def _close(values: Values, errors: Array, by_multipliers: bool) -> Sequence[tuple[int, int]]:
    """The pairs to their errors, the closest first."""
    size = np.abs(values)
    if by_multipliers:
        limits = errors[:, None] * size + errors * size[:, None]
        gaps = np.abs(values[:, None] * values - 1.0)
    else:
        limits = errors[:, None] + errors
        gaps = np.abs(values[:, None] + values)
    close = np.triu(gaps <= limits, 1)
    left = set(range(len(values)))
    found = []
    for i, j in sorted(zip(*np.nonzero(close), strict=True), key=lambda pair: float(gaps[pair])):
        if i in left and j in left:
            left -= {i, j}
            found.append((int(i), int(j)))
    return found


@dataclass(frozen=True, eq=False)
class NeutralMarch(DenseMarch):
    """A dense problem, as the Python march takes it, whose pairs of eigenvalues are exact."""

    problem: AlgebraicEquations
    scale: Array

    def stability(self, z: Array) -> tuple[Array, int, Values]:
        by_multipliers = self.problem.is_map
        values, rates = spectrum(self.problem.linear_part(z))
        if is_suspect(values, by_multipliers):
            values = paired(values, errors_of(self.problem, z, values, self.scale), by_multipliers)
        count, tests = count_and_tests(values, by_multipliers, rates)
        return tests[2:], count, values

    def counted(self, sample: Sample) -> Sample:
        """A point that the compiled march has found, with the tests and eigenvalues of this one."""
        tests, unstable, values = self.stability(sample.z)
        return replace(sample, tests=np.concatenate([sample.tests[:2], tests]), unstable=unstable, eigenvalues=values)


def is_neutral(problem: DenseInOneParameter, z: Array, values: Values, scale: Array) -> bool:
    """True where eigenvalues are pairs to their errors, but not to what the compiled tests allow for.

    Those are of the last but one iterate of Newton's method: pairs on the solution alone are none there.

    values : at z, where they are known.
    """
    if len(values) == problem.n and not is_suspect(values, problem.is_map):
        return False
    known: dict[tuple[bytes, bytes], bool] = kept_with(problem, "neutral places", dict)
    place = z.tobytes(), scale.tobytes()  # asked again for every point that is solved for from z
    if place not in known:
        if len(known) >= REMEMBERED:
            known.clear()
        known[place] = _is_neutral_at(problem, z, scale)
    return known[place]


def _is_neutral_at(problem: DenseInOneParameter, z: Array, scale: Array) -> bool:
    values, _ = spectrum(problem.linear_part(z))
    if not is_suspect(values, problem.is_map):
        return False
    errors = errors_of(problem, z, values, scale)
    taken = paired(values, errors, problem.is_map) != values
    allowed = CLEAR * SAFETY * KNOWN * float(np.abs(values).max())
    if np.any(errors[taken] > allowed):
        return True
    pairs = _close(values, errors, problem.is_map)
    if not pairs:
        return False
    beside = problem.linear_part(z + BESIDE * scale * _alternating(len(z)))
    if not np.all(np.isfinite(beside)):
        return True
    limits = np.full(len(values), 0.5 * allowed)
    return len(_close(spectrum(beside)[0], limits, problem.is_map)) < len(pairs)


def remarks(problem: DenseInOneParameter, z: Array, seen: Values, scale: Callable[[], Array]) -> Sequence[str]:
    """That pairs of eigenvalues stay on the stability boundary along the branch, or along a part of it.

    z, seen (rows, k) : rows and their eigenvalues as the march gave them; scale : the metric.
    """
    distance = np.abs(np.abs(seen) - 1.0) if problem.is_map else np.abs(seen.real)
    size = 1.0 if problem.is_map else np.abs(seen)
    near = np.any((distance <= SUSPECT * size) & (seen.imag > SUSPECT * np.abs(seen)), axis=1)
    counted: dict[int, int] = {}

    def pairs_at(row: int) -> int:
        if row not in counted:
            counted[row] = _pairs_at(problem, z[row], scale())
        return counted[row]

    if near[_places(len(z))].all():
        return _words(min(map(pairs_at, _places(len(z))), default=0), problem.is_map)
    rows = np.flatnonzero(near)
    held = [min(pairs_at(row), _beside(row, near, pairs_at)) for row in rows[_places(len(rows))].tolist()]
    held = [pairs for pairs in held if pairs > 0]
    return _words(min(held), problem.is_map, "a part of the branch") if len(held) >= ENOUGH else ()


def _pairs_at(problem: DenseInOneParameter, z: Array, scale: Array) -> int:
    """How many complex pairs are on the stability boundary at z, to their errors."""
    matrix = problem.linear_part(z)
    if not np.all(np.isfinite(matrix)):
        return 0
    values, _ = spectrum(matrix)
    return _on_boundary(paired(values, errors_of(problem, z, values, scale), problem.is_map), problem.is_map, KNOWN)


def _beside(row: int, near: NDArray[np.bool_], pairs_at: Callable[[int], int]) -> int:
    """How many there are in one of the rows beside it: at a labelled row a pair crosses, beside it none is there."""
    beside = [other for other in (row - 1, row + 1) if 0 <= other < len(near) and near[other]]
    return max((pairs_at(other) for other in beside), default=0)


def remarks_on_orbits(problem: FamilyOfOrbits, z: Array, seen: Values) -> Sequence[str]:
    """The same of the multipliers of a family of orbits (rows z, padded with NaN).

    seen (rows, k) : multipliers from factors of orbits nearby, which tell families without such pairs.
    """
    looked = _places(len(z))
    near = np.sum(np.abs(np.abs(seen[looked]) - 1.0) <= NEARLY, axis=1) - int(problem.autonomous)
    if np.any((near < 2) & np.isfinite(seen[looked]).all(axis=1)):
        return ()
    fewest = problem.n if looked else 0
    for row in z[looked]:
        values = problem.multipliers(row[~np.isnan(row)])
        others = values[1:] if problem.autonomous else values
        if not np.all(np.isfinite(values)):
            return ()
        fewest = min(fewest, _on_boundary(others, True, ON_CIRCLE))
        if fewest == 0:
            return ()
    return _words(fewest, True)


def _places(rows: int) -> list[int]:
    """Some rows; none of a short branch."""
    return [k * (rows - 1) // (LOOKS - 1) for k in range(LOOKS)] if rows >= LOOKS else []


def _on_boundary(values: Values, by_multipliers: bool, limit: float) -> int:
    """How many complex pairs are on the stability boundary, to the limit."""
    if not len(values):
        return 0
    size = 1.0 if by_multipliers else float(np.abs(values).max())
    distance = np.abs(np.abs(values) - 1.0) if by_multipliers else np.abs(values.real)
    return int(np.sum((distance <= limit * size) & (values.imag > np.sqrt(limit) * np.abs(values))))


def _words(pairs: int, by_multipliers: bool, along: str = "the branch") -> Sequence[str]:
    if not pairs > 0:
        return ()
    where, name = ("on the unit circle", "multipliers") if by_multipliers else ("on the imaginary axis", "eigenvalues")
    many = "a pair of" if pairs == 1 else f"{pairs} pairs of"
    return (
        f"{many} {name} stay{'s' if pairs == 1 else ''} {where} along {along}, to rounding, as where an energy or "
        "an area is kept: no bifurcation of theirs is told by a sign, and `stable` says only that none is outside",
    )
