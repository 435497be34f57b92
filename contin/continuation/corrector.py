"""Newton's method on a plane across the curve, for marches in Python: what is corrected is a `Linearisation`.

Matrices may serve for several corrections, as far as the `Decisions` of a march say.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, cast, runtime_checkable

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Failure
from contin.kernels.steering import ONE_POINT, STAGNATION, STALLED, TOLD
from contin.linalg.vectors import dot, norm
from contin.machine import elementary
from contin.offers import offers

NEWTON_LIMIT = 7
CLOSE = 1e-4  # a matrix serves for points this near
FAR = 0.05  # a first correction beyond this is found with a new matrix
UNSEEN = 10.0  # ratio by which a correction may be larger than its residual and the last ones' growth say
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Decisions:
    """What a march decides with; defaults are those of equilibria.

    wanted : length of the first correction that sets the next step, which is of the order `order` in the step.
    iterations : above so many the step shrinks.  guarded, dips : first test that is compared with its prediction, and
    that is looked at for dips.  signed : tests that change sign or vanish are not compared.
    close : a matrix serves again for points this near, ...  patience : ... for so many corrections that are left at the
    rate of the last two.  old : the last step's serves for a first correction below this part of the step.
    off : tangents and tests want a matrix from no farther than that.  cubic : steps are predicted by the cubic through
    two points and their tangents, where corrections are dear; else by the last tangent and its change.
    told : scaled distance of two curves from which on they certainly do not cross.
    """

    wanted: float = 0.02
    order: float = 3.0
    iterations: float = 3.0
    guarded: int = 1
    signed: bool = False
    dips: int = 0
    close: float = CLOSE
    patience: float = np.inf
    old: float = np.inf
    off: float = np.inf
    cubic: bool = False
    told: float = TOLD


EQUILIBRIA = Decisions()
# tests 0 and 1 are of the curve, not of its points
IN_TWO_PARAMETERS = Decisions(guarded=2, signed=True, dips=2, told=ONE_POINT)


class HasSign(Protocol):
    """A square matrix M."""

    @property
    def sign(self) -> float:
        """Of det M, 0 where M is singular."""


class Linearisation(HasSign, Protocol):
    """The scaled equations at a point with the border row [tangent]: M = [J; t^T]."""

    @property
    def residual(self) -> Array:
        """Scaled F, (n,)."""

    @property
    def log_determinant(self) -> float:
        """log |det M|"""

    def solve(self, right: Array) -> Array:
        """M x = right, (n + 1,)."""


class Factorised(Protocol):
    """What is solved with factors, which cost less than the sign of their determinant."""

    @property
    def is_singular(self) -> bool:
        """Whether there are none."""


class Judged(Protocol):
    """A linearisation that knows how well the equations are met where it was made."""

    @property
    def met(self) -> bool:
        """True where what is left of every equation is small beside its linear terms."""


class Forming(Protocol):
    """A linearisation on a curve of branch points."""

    @property
    def form(self) -> Array | None:
        """(2, 2): second derivatives of the branching equation in the plane of the null vectors."""


class Correcting(Protocol):
    """A linearisation that solves for corrections as precisely as Newton's method can use."""

    def correction(self, right: Array, tolerance: float) -> Array:
        """See `Linearisation.solve`; the last correction is to be shorter than the tolerance."""

    @property
    def dear(self) -> bool:
        """Whether a solve takes much longer than a residual."""


class Correctable(Protocol):
    """What Newton's method on a plane needs of a problem."""

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Linearisation | None:
        """None where the equations are not finite."""


@runtime_checkable
class Sparing(Correctable, Protocol):
    """A problem whose matrices cost so many solves that they serve for more than one correction."""

    decisions: Decisions

    def again(self, here: Linearisation, z: Array) -> Linearisation | None:
        """The same matrix with the residual at another point."""


@dataclass(frozen=True, eq=False)
class Corrected:
    """Newton's result on the plane: the point, the last linearisation, and how hard it was.

    off : the (scaled) length from where `last` was made to the point.
    """

    z: Array
    y: Array
    last: Linearisation
    first_correction: float
    iterations: int
    off: float = 0.0


Again = Callable[[Linearisation, Array], Linearisation | None]  # the same matrix with the residual at another point


def correct(
    problem: Correctable, z0: Array, tangent: Array, length: float, y: Array, scale: Array, tolerance: float,
    again: Again | None = None, before: Linearisation | None = None,
    decisions: Decisions = EQUILIBRIA,
) -> Corrected | Failure:  # fmt: skip
    """Newton on [F(z0 + scale y); tangent . y - length] = 0 from the guess y; or why it failed.

    With `again`, matrices serve twice: that of the last step (`before`) for the first iteration, and the first new one
    for what is left to correct after it, as far as `decisions` say. The result's own matrix is from nearby.
    """
    size_before, first, off, gain = np.inf, 0.0, 0.0, 0.0  # gain: of corrections over their residuals
    far = min(FAR, decisions.old * abs(length)) if length else FAR
    slow = False  # at the last rate, chords would be too many
    once_more = True  # where the last matrix may be another one than that of the point
    here, fresh, compare = before, False, False  # compare: the last step was Newton's, so this one must be shorter
    limit = NEWTON_LIMIT if decisions.patience == np.inf else NEWTON_LIMIT + int(decisions.patience)
    for iteration in range(1, limit + 1):
        z = z0 + scale * y
        serves = size_before < decisions.close and not slow if fresh else iteration == 1
        now = again(here, z) if again is not None and here is not None and serves else None
        chord = now is not None
        if now is None:
            now, fresh = problem.linearisation(z, tangent, scale), True
        if now is None:
            return Failure.NOT_FINITE
        if is_singular(now):
            return Failure.SINGULAR
        right = np.append(-now.residual, length - dot(tangent, y))
        if chord and fresh and here is not None and UNSEEN * gain * norm(right) <= tolerance and _is_dear(now):
            return Corrected(z, y, here, first, iteration - 1 - int(before is not None), off)
        size = norm(step := _correction(now, right, tolerance))
        gain = max(gain, size / max(norm(right), TINY))
        if not fresh and not size < far:  # too far for the old matrix
            here = None
            continue
        if not size < 1e3:
            return Failure.DIVERGED
        here = here if chord else now
        off = off + size if chord else size
        y = y + step
        first = size if first == 0.0 else first
        ratio = size / size_before if size_before > 0.0 else 0.0
        left = size * ratio if chord else size * ratio * ratio
        slow = chord and _too_slow(size, ratio, tolerance, decisions.patience)
        met = not offers(type(now), "met") or cast(Judged, now).met
        done = size <= tolerance and (met or not once_more or iteration == limit)
        done = done or (met and size_before < np.inf and size < CLOSE and left < 0.01 * tolerance)
        if not done and compare and ratio > 0.5:
            if not (size < STAGNATION and first > size):
                return Failure.NO_CONTRACTION
            done = ratio > STALLED  # else they fall like a geometric series: beside a singular point, not in rounding
        once_more = once_more and size > tolerance
        if done:
            z, iterations = z0 + scale * y, iteration - int(before is not None)
            if fresh and here is not None:
                return Corrected(z, y, here, first, iterations, off)
            last = problem.linearisation(z, tangent, scale)
            return Failure.NOT_FINITE if last is None else Corrected(z, y, last, first, iterations)
        size_before, compare = size, fresh
    return Failure.NO_CONVERGENCE


def is_singular(here: HasSign) -> bool:
    return cast(Factorised, here).is_singular if offers(type(here), "is_singular") else here.sign == 0


def _correction(here: Linearisation, right: Array, tolerance: float) -> Array:
    if offers(type(here), "correction"):
        return cast(Correcting, here).correction(right, tolerance)
    return here.solve(right)


def _is_dear(here: Linearisation) -> bool:
    """Whether a correction that its residual says to be below the tolerance is not worth its solve."""
    return offers(type(here), "dear") and cast(Correcting, here).dear


def _too_slow(size: float, ratio: float, tolerance: float, patience: float) -> bool:
    """Whether corrections that fall by `ratio` take more than `patience` to reach a tolerance."""
    return patience < np.inf and (ratio >= 1.0 or size * float(elementary.pow(ratio, patience)) > tolerance)
