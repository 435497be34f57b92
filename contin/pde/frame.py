"""Waves that travel along a circle, as equilibria in a frame that moves with them.

With D = d/dx on the unknowns and a given wave w, the equations in the frame are u' = F(u) + c(u) D u with

    c(u) = -(<D w, F(u)> + <D w, u>)/<D w, D u>,    so that    <D w, u>' = -<D w, u>:

states come to <D w, u> = 0, the phase of w, and stay there (the method of slices, Froehlich and Cvitanovic 2012). A
wave of velocity c is an equilibrium; one that returns moved after a time is a periodic orbit, moved by the integral of
c. (With the c that makes |u'| least, Beyn and Thuemmler 2004, the phase of an orbit swings, and families have folds of
the frame's own.) Eigenvalues and multipliers are those of the wave, but for that of translations, which becomes -1
(exp(-T)). Rows of the Jacobian are full, for c depends on all unknowns. Where <D w, D u> = 0 there is no phase.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.pde.local_formula import NOTHING, Jet, Values, subsets
from contin.pde.protocol import Equations, check_full

NO_PHASE: Final = 1e-9  # cosine of D w and D u
PLACES: Final = 64  # along the circle, where a state is tried at
CORRECTIONS: Final = 6  # of a phase, from that of the state before, ...
LONGEST: Final = 0.02  # ... by this part of the circle at most
IN_PLACE: Final = 1e-9


class Travelling:
    """Discretised equations in the frame that moves along the periodic axis number `axis` with a wave."""

    def __init__(self, still: Equations, axis: int, like: Array) -> None:
        self.still, self.n = still, still.n
        self.unknowns, self.grid, self.slots = still.unknowns, still.grid, still.slots
        check_full(self, "travelling")
        self.generator, self._around = self.unknowns.along(axis), self.grid.axes[axis].length
        self._turned = np.asarray(self.generator @ like)
        if not self._turned.any():
            name = self.grid.axes[axis].name
            raise InputError(f"the wave under `travelling` does not change along {name}: write one, as in cos({name})")

    def moves(self, u: Vector) -> bool:
        """False of a state that is the same all along the axis: nothing tells its velocity."""
        return bool((self.generator @ u).any())

    def weight(self, u: Array) -> Array:
        """<D w, D u> of states (..., n): 0 where there is no phase."""
        return np.asarray(self.generator.T @ self._turned @ np.moveaxis(u, -1, 0))

    def in_phase(self, states: Array) -> Array:
        """Samples (K, n) of the equations as they are written, each moved to the phase of w, little by little."""
        from scipy.sparse.linalg import expm_multiply

        D, t, moved, x = self.generator, self._turned, [], 0.0
        everywhere = np.asarray(expm_multiply(D, states[0], start=0.0, stop=self._around, num=PLACES + 1))[:-1]
        rising = self.weight(everywhere) > 0.0  # where <w, u> is largest, not least
        off = np.where(rising, np.abs(everywhere @ t), np.inf)
        x = float(np.argmin(off)) * self._around / PLACES
        for u in states:
            v = np.asarray(expm_multiply(x * D, u, traceA=0.0))
            for _ in range(CORRECTIONS):
                slope = float(t @ (D @ v))
                step = -float(np.clip(t @ v / slope / self._around if slope else 0.0, -LONGEST, LONGEST)) * self._around
                v, x = np.asarray(expm_multiply(step * D, v, traceA=0.0)), x + step
                if abs(step) <= IN_PLACE * self._around:
                    break
            moved.append(v)
        return np.array(moved)

    def velocity(self, u: Vector, p: Values) -> Vector:
        """c(u)"""
        return self._velocity(u, self.generator @ u, self.still.value(u, p))

    def _velocity(self, u: Vector, w: Vector, f: Vector) -> Vector:
        t, below = self._turned, self._turned @ w
        large = np.abs(below) > NO_PHASE * np.sqrt((t @ t) * (np.abs(w) ** 2).sum(axis=0))
        return np.asarray(-(t @ f + t @ u) / np.where(large, below, np.nan))

    def value(self, u: Vector, p: Values) -> Vector:
        """F + c D u, of one state or of K."""
        w, f = self.generator @ u, self.still.value(u, p)
        return np.asarray(f + self._velocity(u, w, f) * w)

    def jacobian(self, u: Array, p: Values) -> csc_matrix:
        """The exact Jacobian, with full rows."""
        D, t = self.generator, self._turned
        w, J = D @ u, self.still.jacobian(u, p)
        c = self._velocity(u, w, self.still.value(u, p))
        slope = -(J.T @ t + t + c * (D.T @ t)) / (t @ w)
        return csc_matrix(J.toarray() + c * D.toarray() + np.outer(w, slope))

    def jacobians(self, u: Array, p: Values) -> list[csc_matrix]:
        """At K states."""
        return [self.jacobian(column, p) for column in u.T]

    def forms(self, u: Array, p: Values, directions: Sequence[tuple[Array, Mapping[str, float]]]) -> Array:
        """D^k (F + c D u)[d_1, ..., d_k], by the rules of products and quotients over their subsets."""
        whole = frozenset(range(len(directions)))
        state: Jet = {NOTHING: u, **{frozenset({k}): d for k, (d, _) in enumerate(directions)}}
        w = {s: self.generator @ x for s, x in state.items()}
        f = {s: self.still.forms(u, p, [directions[k] for k in sorted(s)]) for s in subsets(whole)}
        f[NOTHING] = self.still.value(u, p)
        t = self._turned
        above = {s: t @ f[s] + (t @ state[s] if s in state else 0.0) for s in f}
        c = _quotient(above, {s: t @ x for s, x in w.items()}, whole)
        moved = sum(c[a] * w[whole - a] for a in [NOTHING, *subsets(whole)] if whole - a in w)
        return np.asarray(f[whole] - moved)

    def fields(self, u: Array, p: Values) -> dict[str, Array]:
        """As they are."""
        return self.still.fields(u, p)


def _quotient(above: Jet, below: Jet, whole: frozenset[int]) -> Jet:
    """The jet of a quotient of two numbers: q[S] b = a[S] - sum of b[A] q[S - A]."""
    q: Jet = {}
    for s in [NOTHING, *subsets(whole)]:
        rest = sum(below[a] * q[s - a] for a in subsets(s) if a in below)
        q[s] = np.asarray((above.get(s, 0.0) - rest) / below[NOTHING])
    return q
