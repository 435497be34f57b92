"""Waves that travel along a circle, as equilibria in a frame that moves with them.

With D = d/dx on the unknowns, the equations u' = F(u) + (c + s) D u have a wave of velocity c(u) as an equilibrium:

    c(u) = -<D u, F(u)>/<D u, D u>            removes what moves the wave along itself (Beyn and Thuemmler 2004)
    s(u) = -<D w, u>/<D w, D u>               brings it to the phase of a given wave w

The Jacobian there is that of the flow in the moving frame, but for the eigenvalue 0 of translations, which becomes -1:
all others, and so stability, are those of the wave. Its rows are full, for c depends on all unknowns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.pde.local_formula import NOTHING, Jet, Values, subsets
from contin.pde.protocol import Equations, check_full


class Travelling:
    """Discretised equations in the frame that moves along the periodic axis number `axis` with a wave."""

    def __init__(self, still: Equations, axis: int, like: Array) -> None:
        self.still, self.n = still, still.n
        self.unknowns, self.grid, self.slots = still.unknowns, still.grid, still.slots
        check_full(self, "travelling")
        self.generator = self.unknowns.along(axis)
        self._turned = np.asarray(self.generator @ like)
        if not self._turned.any():
            name = self.grid.axes[axis].name
            raise InputError(f"the wave under `travelling` does not change along {name}: write one, as in cos({name})")

    def moves(self, u: Vector) -> bool:
        """False of a state that is the same all along the axis: nothing tells its velocity."""
        return bool((self.generator @ u).any())

    def velocity(self, u: Vector, p: Values) -> Vector:
        """c(u)"""
        w = self.generator @ u
        return np.asarray(-(w * self.still.value(u, p)).sum(axis=0) / (w * w).sum(axis=0))

    def value(self, u: Vector, p: Values) -> Vector:
        """F + (c + s) D u, of one state or of K."""
        w, f = self.generator @ u, self.still.value(u, p)
        c = -(w * f).sum(axis=0) / (w * w).sum(axis=0)
        s = -(self._turned @ u) / (self._turned @ w)
        return np.asarray(f + (c + s) * w)

    def jacobian(self, u: Array, p: Values) -> csc_matrix:
        """The exact Jacobian, with full rows."""
        D, t = self.generator, self._turned
        w, f, J = D @ u, self.still.value(u, p), self.still.jacobian(u, p)
        square, along, phase, turned = w @ w, w @ f, t @ u, t @ w  # 0 of a state that does not change: all is NaN
        rate = -along / square - phase / turned
        by_c = -(D.T @ f + J.T @ w) / square + 2.0 * along / square**2 * (D.T @ w)
        by_s = -t / turned + phase / turned**2 * (D.T @ t)
        return csc_matrix(J.toarray() + rate * D.toarray() + np.outer(w, by_c + by_s))

    def jacobians(self, u: Array, p: Values) -> list[csc_matrix]:
        """At K states."""
        return [self.jacobian(column, p) for column in u.T]

    def forms(self, u: Array, p: Values, directions: Sequence[tuple[Array, Mapping[str, float]]]) -> Array:
        """D^k (F + (c + s) D u)[d_1, ..., d_k], by the rules of products and quotients over their subsets."""
        whole = frozenset(range(len(directions)))
        state: Jet = {NOTHING: u, **{frozenset({k}): d for k, (d, _) in enumerate(directions)}}
        w = {s: self.generator @ x for s, x in state.items()}
        f = {s: self.still.forms(u, p, [directions[k] for k in sorted(s)]) for s in subsets(whole)}
        f[NOTHING] = self.still.value(u, p)
        phase = {s: self._turned @ x for s, x in state.items()}
        turned = {s: self._turned @ x for s, x in w.items()}
        c = _quotient(_inner(w, f, whole), _inner(w, w, whole), whole)
        s = _quotient(phase, turned, whole)
        moved = sum((c[a] + s[a]) * w[whole - a] for a in [NOTHING, *subsets(whole)] if whole - a in w)
        return np.asarray(f[whole] - moved)

    def fields(self, u: Array, p: Values) -> dict[str, Array]:
        """As they are."""
        return self.still.fields(u, p)


def _inner(a: Jet, b: Jet, whole: frozenset[int]) -> Jet:
    """The inner product of two jets, those of a being few."""
    return {
        s: np.asarray(sum((x * b[s - part]).sum(axis=0) for part, x in a.items() if part <= s and s - part in b))
        for s in [NOTHING, *subsets(whole)]
    }


def _quotient(above: Jet, below: Jet, whole: frozenset[int]) -> Jet:
    """The jet of a quotient of two numbers: q[S] b = a[S] - sum of b[A] q[S - A]."""
    q: Jet = {}
    for s in [NOTHING, *subsets(whole)]:
        rest = sum(below[a] * q[s - a] for a in subsets(s) if a in below)
        q[s] = np.asarray((above.get(s, 0.0) - rest) / below[NOTHING])
    return q
