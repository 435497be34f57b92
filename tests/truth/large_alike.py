"""Random systems about a zero state, dense or sparse: kernels of any dimension, Hopf pairs, turned and scaled.

In modes, x' = (lam + s mu - c) x + terms of second and third order for real modes and
(lam - mu t - c + i w) y for pairs. Eigenvalues are known in closed form: which labels are where is known too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

import contin
from contin.abi import Array


@dataclass(frozen=True)
class Planted:
    """Real modes at `places` with multiplicities, pairs at `pairs` with frequencies; the rest is stable."""

    places: Array
    multiplicities: Array
    pairs: Array
    frequencies: Array
    slopes: Array  # dc/dmu of the pairs
    stable: Array
    quadratic: Array
    turn: sp.csc_matrix  # orthogonal

    @property
    def n(self) -> int:
        """States."""
        return self.turn.shape[0]

    def labels(self) -> list[tuple[str, float, int]]:
        """(type, lam, dimension of the kernel) in order."""
        real = [("BP", float(c), int(k)) for c, k in zip(self.places, self.multiplicities, strict=True)]
        return sorted(real + [("HB", float(c), 2) for c in self.pairs], key=lambda x: x[1])

    def problem(self, sparse: bool) -> contin.FunctionProblem:
        """As a function with a sparse or a dense Jacobian."""
        c = np.concatenate([np.repeat(self.places, self.multiplicities), np.repeat(self.pairs, 2), self.stable])
        first = int(self.multiplicities.sum())
        swap = np.zeros((self.n, self.n))
        for k, w in enumerate(self.frequencies):
            i = first + 2 * k
            swap[i, i + 1], swap[i + 1, i] = -w, w
        swap, q, a = sp.csc_matrix(swap), self.turn, self.quadratic
        tilt = np.zeros(self.n)
        tilt[first : first + 2 * len(self.pairs)] = np.repeat(self.slopes, 2)

        def rate(p):
            return p["lam"] - c - p["mu"] * tilt

        def residual(u, p):
            x = q.T @ u
            return q @ (rate(p) * x + swap @ x + a * x * np.roll(x, 1) - x**3)

        def jacobian(u, p):
            x = q.T @ u
            diagonal = sp.diags_array(rate(p) + a * np.roll(x, 1) - 3 * x**2)
            beside = sp.csc_matrix((a * x, (np.arange(self.n), np.roll(np.arange(self.n), 1))), shape=(self.n, self.n))
            matrix = (q @ (diagonal + swap + beside) @ q.T).tocsc()
            return matrix if sparse else matrix.toarray()

        return contin.FunctionProblem(residual, np.zeros(self.n), {"lam": 0.0, "mu": 0.0}, jacobian)


def planted(seed: int) -> Planted:
    """A random one: 2 to 5 places at least 0.1 apart, of kernels of dimension 1 to 4, 22 to 90 states."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 6))
    spots = 0.2 + np.cumsum(rng.uniform(0.1, 0.4, count))
    hopf = rng.random(count) < 0.4
    multiplicities = rng.choice([1, 1, 2, 3, 4], count)[~hopf]
    n = int(rng.integers(22, 90))
    used = int(multiplicities.sum()) + 2 * int(hopf.sum())
    stable = np.exp(rng.uniform(np.log(4.0), np.log(400.0), n - used))
    turn = sp.csc_matrix(sp.identity(n))
    for _ in range(2):
        order, angle = rng.permutation(n), rng.uniform(0, 2 * np.pi, n // 2)
        i, j = order[: n // 2 * 2 : 2], order[1 : n // 2 * 2 : 2]
        diagonal = np.ones(n)
        diagonal[i], diagonal[j] = np.cos(angle), np.cos(angle)
        here = sp.csc_matrix((np.sin(angle), (i, j)), shape=(n, n))
        turn = (sp.diags_array(diagonal) + here - here.T) @ turn
    return Planted(
        spots[~hopf], multiplicities, spots[hopf], np.exp(rng.uniform(-1, 1.5, int(hopf.sum()))),
        rng.uniform(-0.5, 0.5, int(hopf.sum())), stable, rng.uniform(-1, 1, n) * (rng.random() < 0.5),
        sp.csc_matrix(turn),
    )  # fmt: skip
