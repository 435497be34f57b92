"""The linearised equations of an orbit, solved from interval to interval.

    (1 x M) d_j - 1 x M d_{j-1,3} - T h_j (A x J) d_j = r_j,    d_{-1} = d_{N-1}

with the mass matrix M, or the identity, and J at the interval's three points. Intervals are factored by themselves, or
solved with factors that all of one length share (`reused`). Going once round is the action of the monodromy matrix,
called M from here on; closure, period, parameter and the conditions (phase, arclength) make a system of n + 2 unknowns
(d_{N-1,3}, dT, dp) with I - M in it, which GMRES solves: M has few eigenvalues that are not small where a system
dissipates (Sanchez, Net, Garcia-Archilla and Simo 2004).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.linalg.factor import Factoriser
from contin.linalg.krylov import Accuracy, gmres
from contin.linalg.recycled import Recycled
from contin.linalg.vectors import norm
from contin.problems.large_orbits.interval import Pattern, full_diagonals, one_pattern
from contin.problems.large_orbits.radau import STAGES
from contin.problems.large_orbits.reused import intervals_with_shared_factors

SMALL: Final = 10_000  # unknowns up to which every interval is factored by itself, solves being quicker
MANY: Final = 800_000  # unknowns times intervals from which factors of all may take over 2.4 GB (a march has three
# sets of them), ...
NUMBERS: Final = 300_000_000  # ... and of bands, whose size is known, the numbers that do


class Interval(Protocol):
    """Solves with the matrix of one interval; the three points of a state stand beside each other."""

    def solve(self, right: Vector) -> Vector:
        """Of a right side, or of columns."""

    def solve_transposed(self, right: Vector) -> Vector: ...


@dataclass(frozen=True, eq=False)
class Sweeps:
    """Solvers of all intervals."""

    intervals: Sequence[Interval]
    n: int
    mass: csc_matrix | None = None

    @classmethod
    def of(
        cls, jacobians: Sequence[csc_matrix], steps: Array, factoriser: Factoriser, mass: csc_matrix | None = None
    ) -> Sweeps:
        """From J at all points, three by three; steps = T h (intervals,)."""
        weights = [] if mass is None else full_diagonals([mass])
        matrices = one_pattern([*full_diagonals(jacobians), *weights])
        own = None if mass is None else matrices.pop()
        n = matrices[0].shape[0]
        pattern = Pattern.of(matrices[0])
        threes = [matrices[k : k + STAGES] for k in range(0, len(matrices), STAGES)]
        pairs = list(zip(threes, steps.tolist(), strict=True))
        band = factoriser.band_entries(pattern.matrix(*pairs[0], own))
        if band * len(pairs) > NUMBERS if band is not None else n > SMALL or n * len(pairs) > MANY:
            return cls(intervals_with_shared_factors(pairs, factoriser.tally, mass), n, mass)
        return cls([factoriser.factor(pattern.matrix(three, step, own)) for three, step in pairs], n, mass)

    def _weighed(self, x: Vector) -> Vector:
        return x if self.mass is None else np.asarray(self.mass @ x)

    def along(
        self, beginning: Vector, right: Vector | None = None, jumps: Mapping[int, Vector] | None = None
    ) -> Vector:
        """d (intervals, 3, n) from d_{-1,3} = `beginning` (n,) and r (intervals, 3, n), real or complex.

        jumps : what is added (n,) where intervals of these places begin.
        """
        parts = [beginning] if right is None else [beginning, right]
        out = np.empty((len(self.intervals), STAGES, self.n), np.result_type(*parts))
        x = beginning
        for j, interval in enumerate(self.intervals):
            if jumps is not None and j in jumps:
                x = x + jumps[j]
            held = self._weighed(x)
            known = np.repeat(held, STAGES) if right is None else (right[j] + held).T.ravel()
            out[j] = interval.solve(known).reshape(self.n, STAGES).T
            x = out[j, 2]
        return out

    def monodromy(self, w: Vector) -> Vector:
        """M w, of a vector (n,) or of columns (n, k)."""
        x = w
        for interval in self.intervals:
            x = interval.solve(np.repeat(self._weighed(x), STAGES, axis=0))[STAGES - 1 :: STAGES]
        return x

    def transposed(self, w: Vector) -> Vector:
        """M^T w, from interval to interval back in time."""
        x = w
        for interval in reversed(self.intervals):
            _, x = self._back(interval, x)
        return x

    def backwards(self, w: Vector) -> Vector:
        """y (intervals, 3, n): w . d_{N-1,3} is the sum of y r over all points, for what r leads to from rest."""
        out, x = np.empty((len(self.intervals), STAGES, self.n), np.asarray(w).dtype), w
        for j in reversed(range(len(self.intervals))):
            y, x = self._back(self.intervals[j], x)
            out[j] = y.T
        return out

    def _back(self, interval: Interval, x: Vector) -> tuple[Vector, Vector]:
        """The interval's transposed solution (n, 3), and what it makes of the state where the interval begins."""
        known = np.zeros((self.n, STAGES), x.dtype)
        known[:, -1] = x
        y = interval.solve_transposed(known.ravel()).reshape(self.n, STAGES)
        begun = y.sum(axis=1)
        return y, begun if self.mass is None else np.asarray(self.mass.T @ begun)


Jumps = Mapping[int, Vector]
Pick = Callable[[Vector, Vector, Jumps | None], Vector]
Wanted = Callable[[float], float]  # from the length of a solution (scaled) the error that is small enough


@dataclass(frozen=True, eq=False)
class Closed:
    """The closed orbit's equations with k columns (period, parameters) and k rows, in units of their own.

    rows (k, S + k), S unknowns of an orbit.  sizes (1 + k,) : of states, T and p.
    answers (k, N, 3, n) : what the columns by dT and dp lead to from a beginning at rest.
    gaps (k, n) : what the columns add where the orbit closes, if any does.
    pick : (d (N, 3, n), d_{-1,3} (n,), jumps) -> what changes of the S unknowns belong to them.
    recycled : what solves have learnt, of these equations and of those of points nearby.
    """

    sweeps: Sweeps
    rows: Array
    sizes: Array
    answers: Array
    pick: Pick
    recycled: Recycled
    gaps: Array | None = None

    def solve(
        self, right: Array | None, jumps: Jumps | None, below: Array, again: bool = False, wanted: Wanted | None = None
    ) -> tuple[Array, Array, int]:
        """Changes of the S unknowns and (dT, dp), and the iterations; for r (N, 3, n) and `below` (k,) of the rows.

        jumps : where intervals begin, that of the first interval being d_{-1} - d_{N-1,3}.
        again : once more for the residual, so that what is nearly singular is solved to rounding.
        wanted : where less than that will do; lengths are those of (d_{-1}, dT, dp), each in its size.
        """
        n, k = self.sweeps.n, len(self.answers)
        size = self.sizes[0] * np.sqrt(n)
        units = np.append(np.full(n, size), self.sizes[1:])
        row_sizes = np.abs(self.rows[:, :-k]).sum(axis=1) * self.sizes[0] + np.abs(self.rows[:, -k:]) @ self.sizes[1:]
        rest = np.zeros(n)
        gap = rest if jumps is None else jumps.get(0, rest)
        inner = None if jumps is None else {j: jump for j, jump in jumps.items() if j > 0}
        particular = np.zeros_like(self.answers[0])
        if right is not None or inner:
            particular = self.sweeps.along(rest, right, inner)

        def whole(w: Array) -> Array:
            return np.asarray(self.sweeps.along(w[:n]) + np.einsum("k,kjin->jin", w[n:], self.answers))

        def conditions(d: Array, w: Array, tp: Array, known: Jumps | None = None) -> Array:
            return np.asarray((self.rows[:, :-k] @ self.pick(d, w, known) + self.rows[:, -k:] @ tp) / row_sizes)

        def apply(v: Array) -> Array:
            w = v * units
            d = whole(w)
            closed = w[:n] - d[-1, 2] if self.gaps is None else w[:n] - d[-1, 2] - w[n:] @ self.gaps
            return np.append(closed / size, conditions(d, w[:n], w[n:]))

        known = np.append(
            (particular[-1, 2] + gap) / size,
            below / row_sizes - conditions(particular, rest, np.zeros(k), inner),
        )
        enough = None if wanted is None else Accuracy(norm, lambda v: wanted(norm(v)))
        precondition, learn = self.recycled.precondition, self.recycled.learn
        v, iterations, _ = gmres(apply, precondition, known, accuracy=enough, learn=learn)
        if again:
            more, further, _ = gmres(apply, precondition, known - apply(v), learn=learn)
            v, iterations = v + more, iterations + further
        w = v * units
        return self.pick(particular + whole(w), w[:n], inner), w[n:], iterations
