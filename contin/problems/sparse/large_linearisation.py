"""The bordered linearisation of a large system, and how well iterative solvers are to solve with it.

A correction by Newton's method leaves an error of second order, so it is solved for to a part of its own length; of a
tangent the fold's test wants dp/ds as a part of itself. Errors are those that the preconditioner estimates.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.extrapolation import REACH, cubic
from contin.linalg.eigen import Region
from contin.linalg.krylov import Accuracy
from contin.linalg.linear import KrylovBordered, Linear, Solution
from contin.linalg.region_of_pencil import RegionOfPencil
from contin.linalg.vectors import dot, generic, norm, norm_in_units
from contin.machine import elementary
from contin.problems.tolerances import SETTLED

# errors (scaled) of what is solved for by iteration:
ROUGH = 0.1  # of a correction with an old matrix, as a part of it
LONG = 1e-2  # of any correction, as a part of it
BELOW = 1e-2  # of any correction, as a part of the tolerance that the last one is to meet
QUADRATIC = 0.1  # of Newton's correction of length 1
TANGENT = 1e-5  # of a tangent, as a part of it, ...
SLOPE = 1e-3  # ... and of dp/ds
ROUNDED = 1e-14  # at best
ALONG = 0.5  # cosine between a border and the last tangent from which that is a guess of the next
CHORD = 1e-3  # (scaled) from which the chord between two points says more about the tangent than rounding


@dataclass(eq=False)
class Workspace:
    """What a problem remembers of the last points: their operators, and eigenvectors to start from."""

    z: Array | None = None
    linear: Linear | None = None
    start: Array | None = None
    vectors: NDArray[np.complex128] | None = None
    before: NDArray[np.complex128] | None = None  # those of the point before, see `followed`
    seen: Array | None = None  # where `vectors` are eigenvectors
    region: Region = field(default_factory=Region)
    of_pencil: RegionOfPencil | None = None
    tangent: tuple[Array, Array] | None = None  # the last one, unscaled, and where it is one
    earlier: tuple[Array, Array] | None = None  # the one before it that is not from next to there, ...
    beside: tuple[Array, Array] | None = None  # ... and one that is
    by_entries: tuple[Linear, Linear] | None = None  # an operator known by products, and the same by its matrix
    judged: tuple[Array, NDArray[np.complex128]] | None = None  # a point and its eigenvalues
    unseen: tuple[float, float] | None = None  # modulus up to which eigenvalues were computed at least, and to be
    too_far: float = np.inf  # radius that Krylov spaces do not reach
    reach: float = 0.0  # largest modulus of an eigenvalue that was unstable or nearly so


@dataclass(frozen=True, eq=False)
class LargeLinearisation:
    """Scaled residual, and M = [J; t] in scaled unknowns, solved by elimination of the border."""

    residual: Array
    sign: float  # of det M, where factors give it
    scale: Array
    _solution: Solution
    row: Array | None = None  # of the border, unscaled, ...
    work: Workspace | None = None  # ... where the last tangent is
    z: Array | None = None  # the point
    rough: bool = False  # solves only as well as a correction with an old matrix needs

    @cached_property
    def smallest(self) -> float | None:
        """1 / |M^-1 r| with r random, about the smallest singular value of M; None where M has no factors.

        (Smooth null vectors are nearly orthogonal to an r of a pattern.)
        """
        if isinstance(self._solution, KrylovBordered):
            return None
        length = norm(self.solve(generic(len(self.residual) + 1)))
        return 1.0 / length if 0.0 < length < np.inf else 0.0

    @property
    def dear(self) -> bool:
        """Where solves are iterative."""
        return isinstance(self._solution, KrylovBordered)

    @property
    def log_determinant(self) -> float:
        """In place of log |det M|, which swings by many powers of ten when n is large: log `smallest`.

        The test for branch points becomes the determinant's sign times that. Where that sign is not known, nor is this.
        """
        return elementary.log(self.smallest) if self.smallest else 0.0

    def solve(self, right: Array) -> Array:
        """M x = right, in scaled unknowns."""
        return self.correction(right, 0.0)

    def correction(self, right: Array, tolerance: float) -> Array:
        """M x = right for Newton's method, whose last correction is to meet a tolerance."""
        d = self.scale[:-1]
        both = np.append(d * right[:-1], right[-1])
        if not isinstance(self._solution, KrylovBordered):
            x = self._solution.solve(both)
        elif right[:-1].any():
            wanted = _of_chord if self.rough else _of_newton
            floor = max(BELOW * tolerance, SETTLED)

            def enough(size: float) -> float:
                return max(wanted(size), floor)

            x = self._solution.solve(both, accuracy=Accuracy(self._size, lambda x: enough(self._size(x)), enough))
        else:
            x = self._tangent(self._solution, both)
        return np.asarray(x / self.scale)

    def _size(self, x: Array) -> float:
        return norm_in_units(x, self.scale)

    def _of_tangent(self, x: Array) -> float:
        """The fold's test is dp/ds, which must be right as a part of itself."""
        size, slope = self._size(x), abs(float(x[-1] / self.scale[-1]))
        return max(min(TANGENT * size, SLOPE * slope), ROUNDED * size)

    def _tangent(self, solution: KrylovBordered, right: Array) -> Array:
        """A multiple of the tangent, from the last one that was computed."""
        accuracy = Accuracy(self._size, self._of_tangent, lambda size: TANGENT * size)
        if self.row is None or self.work is None or self.z is None:
            return solution.solve(right, accuracy=accuracy)
        guess = self._guessed()
        if guess is not None:
            along = dot(self.row, guess)
            far = abs(along) < ALONG * norm(self.row * self.scale) * norm(guess / self.scale)
            guess = None if far else guess * (right[-1] / along)
        x = solution.solve(right, guess, accuracy)
        if np.all(np.isfinite(x)) and x.any():
            known = self.work.tangent
            far = known is not None and norm((self.z - known[1]) / self.scale) > CHORD
            if far:
                self.work.earlier = known
            self.work.beside = None if far else known
            self.work.tangent = x, self.z
        return x

    def _guessed(self) -> Array | None:
        """The last tangent t, or where it goes from the one beside it; far from it that of a polynomial through what is
        known, or of the parabola: 2 c - t, c a chord with t.c = |c|^2.
        """
        known = None if self.work is None else self.work.tangent
        if known is None or self.work is None or self.z is None:
            return None
        t, place = known
        chord = (self.z - place) / self.scale
        scaled = t / self.scale
        if not norm(chord) > CHORD:
            return np.asarray(self.scale * self._turned(scaled, place, chord))
        if self.work.earlier is not None:
            slope, at = self.work.earlier
            curve = cubic(scaled / norm(scaled), (at - place) / self.scale, slope / self.scale)
            better = None if curve is None else curve.slope_at(chord)
            if better is not None:
                return np.asarray(self.scale * better)
        return np.asarray(self.scale * (2.0 * dot(scaled, chord) / dot(chord, chord) * chord - scaled))

    def _turned(self, t: Array, place: Array, chord: Array) -> Array:
        """The (scaled) tangent at the end of a short chord from `place`, where it is t, as it turned before."""
        beside = None if self.work is None else self.work.beside
        if beside is None:
            return t
        back, way = dot(t, (beside[1] - place) / self.scale), dot(t, chord)
        before = beside[0] / self.scale
        along = dot(t, before)
        if not 0.0 < abs(way) < REACH * abs(back) or along == 0.0:  # farther, what is seen of its turning is rounding
            return t
        return np.asarray(t + way / back * (before * (dot(t, t) / along) - t))


def _of_chord(size: float) -> float:
    """The error that a correction of this size may have."""
    return ROUGH * size


def _of_newton(size: float) -> float:
    return min(QUADRATIC * size, LONG) * size
