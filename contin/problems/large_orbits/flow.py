"""The flow of a large system by Radau's method of order 5, with steps whose solvers serve again.

Stages U (3, n) of a step of length t solve U - x - t A f(U) = 0 by Newton's method with the solver of an orbit nearby,
or of the last step; it is made anew where it contracts slowly (Hairer and Wanner, Solving Ordinary Differential
Equations II, sec. IV.8). They are solved for to rounding, so that the flow is smooth and has an exact derivative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.factor import Factoriser
from contin.linalg.vectors import norm
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import STAGES, A
from contin.problems.large_orbits.sweeps import Interval, Sweeps

SETTLED: Final = 1e-14  # of a correction, relative to the states
AHEAD: Final = 0.5  # of that: a correction that is not made, for the last two tell its size
ROUNDED: Final = 1e-9  # from which a correction that does not shrink is rounding
SLOW: Final = 0.2  # contraction from which a solver is made anew
ITERATIONS: Final = 30
RENEWALS: Final = 4


@dataclass(frozen=True, eq=False)
class Known:
    """Stages (N, 3, n) of an orbit nearby, where its intervals begin (N, n), and solvers where there are some."""

    U: Array
    beginnings: Array
    intervals: tuple[Interval, ...] = ()


@dataclass(eq=False)
class Stepper:
    """Steps at parameters p, and the last solver that was made."""

    points: Points
    p: Array
    size: float  # of the states
    factoriser: Factoriser
    made: tuple[float, Interval] | None = None

    def step(self, x: Array, length: float, guess: Array, solver: Interval | None) -> Array | None:
        """U (3, n); None where Newton's method does not converge or an equation is not finite."""
        if solver is None and self.made is not None and self.made[0] == length:
            solver = self.made[1]
        U, before, renewals = guess, np.inf, 0
        for _ in range(ITERATIONS):
            if solver is None:
                solver = self._made_at(U, length)
                renewals += 1
            if solver is None or renewals > RENEWALS:
                return None
            with np.errstate(all="ignore"):
                left = U - x - length * (A @ self.points.values(U, self.p))
            if not np.isfinite(left).all():
                return None
            change = solver.solve(-left.T.ravel()).reshape(-1, STAGES).T
            size = norm(change.ravel()) / self.size
            if not math.isfinite(size):
                return None
            rate = size / before
            ahead = rate * size if U is not guess else np.inf  # about the next correction, from the second one on
            if size <= SETTLED or ahead <= AHEAD * SETTLED or (rate >= 0.5 and size < ROUNDED):
                return U + change
            U = U + change
            if rate > SLOW and size > ROUNDED:
                solver = None
            before = size
        return None

    def _made_at(self, U: Array, length: float) -> Interval | None:
        matrices = self.points.jacobians(U, self.p)
        if matrices is None:
            return None
        solver = Sweeps.of(matrices, np.array([length]), self.factoriser).intervals[0]
        self.made = length, solver
        return solver


def flow(stepper: Stepper, starts: dict[int, Array], lengths: Array, known: Known | None) -> Known | None:
    """Stages of steps of these lengths (N,), beginning at `starts`: values (n,) by the step, of 0 at least."""
    fits = known is not None and len(known.U) == len(lengths)
    x, U, beginnings = starts[0], [], []
    for j, length in enumerate(lengths.tolist()):
        x = starts.get(j, x)
        solver = None
        if known is not None and fits:
            guess = known.U[j] + (x - known.beginnings[j])
            solver = known.intervals[j] if known.intervals else None
        else:
            guess = np.tile(x, (STAGES, 1))
        made = stepper.step(x, length, guess, solver)
        if made is None:
            return None
        U.append(made)
        beginnings.append(x)
        x = made[2]
    return Known(np.array(U), np.array(beginnings), known.intervals if known is not None and fits else ())


def local_errors(stepper: Stepper, found: Known, lengths: Array) -> Array:
    """Errors of single steps (N,): each against two of half the length."""
    errors = np.empty(len(lengths))
    for j, length in enumerate(lengths.tolist()):
        halves = flow(stepper, {0: found.beginnings[j]}, np.full(2, 0.5 * length), None)
        errors[j] = np.inf if halves is None else norm(halves.U[-1, 2] - found.U[j, 2])
    return errors
