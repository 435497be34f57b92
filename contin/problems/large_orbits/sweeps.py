"""The linearised equations of an orbit, solved from interval to interval.

    d_j - 1 x d_{j-1,3} - T h (A x J) d_j = r_j,    d_{-1} = d_{N-1}

with J at the interval's three points. Each interval is factored by itself, so memory and time are proportional to n
times intervals where J is banded. Going once round is the action of the monodromy matrix M; closure, period, parameter
and the conditions (phase, arclength) make a system of n + 2 unknowns (d_{N-1,3}, dT, dp) with I - M in it, which
GMRES solves: M has few eigenvalues that are not small where a system dissipates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.linalg.factor import Factor, Factoriser
from contin.linalg.krylov import gmres
from contin.problems.large_orbits.interval import Pattern, full_diagonal, one_pattern
from contin.problems.large_orbits.radau import STAGES


@dataclass(frozen=True, eq=False)
class Sweeps:
    """Factors of all intervals."""

    factors: Sequence[Factor]
    n: int

    @classmethod
    def of(cls, jacobians: Sequence[csc_matrix], step: float, factoriser: Factoriser) -> Sweeps:
        """From J at all points, three by three; step = T h."""
        matrices = one_pattern([full_diagonal(J) for J in jacobians])
        pattern = Pattern.of(matrices[0])
        threes = [matrices[k : k + STAGES] for k in range(0, len(matrices), STAGES)]
        return cls([factoriser.factor(pattern.matrix(three, step)) for three in threes], matrices[0].shape[0])

    def along(self, beginning: Vector, right: Vector | None = None) -> Vector:
        """d (intervals, 3, n) from d_{-1,3} = `beginning` (n,) and r (intervals, 3, n), real or complex."""
        kind = beginning.dtype if right is None else np.result_type(beginning, right)
        out = np.empty((len(self.factors), STAGES, self.n), kind)
        x = beginning
        for j, factor in enumerate(self.factors):
            known = np.broadcast_to(x, (STAGES, self.n)) if right is None else right[j] + x
            out[j] = factor.solve(known.T.ravel()).reshape(self.n, STAGES).T
            x = out[j, 2]
        return out

    def monodromy(self, w: Vector) -> Vector:
        """M w."""
        return np.asarray(self.along(w)[-1, 2])

    def transposed(self, w: Vector) -> Vector:
        """M^T w, from interval to interval back in time."""
        x = w
        for factor in reversed(self.factors):
            known = np.zeros((self.n, STAGES), x.dtype)
            known[:, -1] = x
            x = factor.solve_transposed(known.ravel()).reshape(self.n, STAGES).sum(axis=1)
        return x


@dataclass(frozen=True, eq=False)
class Closed:
    """The closed orbit's equations with k columns (period, parameters) and k rows, in units of their own.

    columns (k, N, 3, n) : of the equations, by dT and dp.  rows (k, N 3 n + k).  sizes (1 + k,) : of states, T and p.
    """

    sweeps: Sweeps
    columns: Array
    rows: Array
    sizes: Array
    answers: Array  # what `columns` lead to from a beginning at rest, (k, N, 3, n)

    @classmethod
    def of(cls, sweeps: Sweeps, columns: Array, rows: Array, sizes: Array) -> Closed:
        rest = np.zeros(sweeps.n)
        answers = np.array([sweeps.along(rest, -column) for column in columns])
        return cls(sweeps, columns, rows, sizes, answers)

    def solve(self, right: Array, below: Array, again: bool = False) -> tuple[Array, Array, int]:
        """d (N, 3, n) and (dT, dp) for right-hand sides (N, 3, n) and (k,); and the iterations.

        again : once more for the residual, so that what is nearly singular is solved to rounding.
        """
        n, k = self.sweeps.n, len(self.columns)
        units = np.append(np.full(n, self.sizes[0]), self.sizes[1:])
        row_sizes = np.abs(self.rows[:, :-k]).sum(axis=1) * self.sizes[0] + np.abs(self.rows[:, -k:]) @ self.sizes[1:]
        particular = self.sweeps.along(np.zeros(n), right)

        def whole(w: Array) -> Array:
            return np.asarray(self.sweeps.along(w[:n]) + np.einsum("k,kjin->jin", w[n:], self.answers))

        def conditions(d: Array, tp: Array) -> Array:
            return np.asarray((self.rows[:, :-k] @ d.ravel() + self.rows[:, -k:] @ tp) / row_sizes)

        def apply(v: Array) -> Array:
            w = v * units
            d = whole(w)
            return np.append((w[:n] - d[-1, 2]) / self.sizes[0], conditions(d, w[n:]))

        known = np.append(particular[-1, 2] / self.sizes[0], below / row_sizes - conditions(particular, np.zeros(k)))
        v, iterations, _ = gmres(apply, lambda r: r, known)
        if again:
            more, further, _ = gmres(apply, lambda r: r, known - apply(v))
            v, iterations = v + more, iterations + further
        w = v * units
        return particular + whole(w), w[n:], iterations
