"""Two branches with one tangent: where they run beside each other, and the order of their contact.

At a point where J = [F_u F_p] (n, n + 1) has corank 1, points near it are y + s t + w e + v with t, e an orthonormal
basis of ker J and v normal to it. For given (s, w) the equations F = mu psi (psi the left null vector) and N^T v = 0
determine v and the scalar mu = h(s, w) (Lyapunov-Schmidt), so the branches are the zeros w(s) of h(s, .). Two that
share the tangent t differ by |w2 - w1| ~ s^m: m is the order of their contact, 2 where they touch like parabolas.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine.elementary import log2
from contin.problems.defining import singular_basis
from contin.problems.scaled import ScaledSystem

DISTANCES: Final = tuple(0.15 / 2.0**k for k in range(7))  # scaled, at which the two branches are told apart
BUDGET: Final = 12
SETTLED: Final = 1e-14  # corrections below this are rounding
TOLD_APART: Final = 1e-5  # gap from which Newton's method tells the two branches apart
RESOLVED: Final = 1e-7  # gaps below this are made of rounding
WHOLE: Final = 0.2  # an exponent this near to a whole number is that number


@dataclass(frozen=True, eq=False)
class Sheets:
    """The reduced equation h(s, w) = 0 along a common tangent."""

    local: ScaledSystem
    y: Array
    tangent: Array  # t
    across: Array  # e
    left: Array  # psi

    @classmethod
    def at(cls, local: ScaledSystem, y: Array) -> Sheets:
        """Along the direction in which the quadratic part of the reduced equation vanishes twice."""
        left, kernel = singular_basis(local.linearise(y)[1], 1)
        psi = left[:, 0]
        c = np.array([[float(psi @ local.form(y, kernel[:, i], kernel[:, j])) for j in range(2)] for i in range(2)])
        sizes, axes = np.linalg.eigh(c)
        order = np.argsort(np.abs(sizes))
        return cls(local, y, kernel @ axes[:, order[0]], kernel @ axes[:, order[1]], psi)

    def reduced(self, s: float, w: float, v: Array) -> tuple[float, float, Array] | None:
        """h(s, w), its derivative in w, and v; None where the other equations have no solution near the guess v."""
        n = self.local.n
        size = np.inf
        for _ in range(BUDGET):
            f, jacobian = self.local.linearise(self.y + s * self.tangent + w * self.across + v)
            matrix = np.zeros((n + 2, n + 2))
            matrix[:n, : n + 1], matrix[:n, n + 1] = jacobian, -self.left
            matrix[n], matrix[n + 1] = np.append(self.tangent, 0.0), np.append(self.across, 0.0)
            right = np.column_stack([np.append(-f, [-self.tangent @ v, -self.across @ v]), np.zeros(n + 2)])
            right[:n, 1] = -jacobian @ self.across
            try:
                step = np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            before, size = size, float(np.linalg.norm(step[:-1, 0]))
            if not np.isfinite(size) or size > 1.0:
                return None
            v = v + step[:-1, 0]
            if size < SETTLED or (size < 1e-9 and size > 0.5 * before):
                return float(step[-1, 0]), float(step[-1, 1]), v
        return None

    def roots(self, s: float) -> tuple[float, float] | None:
        """The two w(s), the smaller first; None where they are not two real ones."""
        v = np.zeros(len(self.y))
        start = self.reduced(s, 0.0, v)
        if start is None:
            return None
        h0, h1, v = start
        step = max(abs(s) * abs(s), 1e-4)
        beside = self.reduced(s, step, v)
        if beside is None:
            return None
        h2 = (beside[1] - h1) / (2.0 * step)
        if h2 == 0.0:
            return None
        discriminant = h1 * h1 - 4.0 * h0 * h2
        if discriminant <= 0.0:
            return None
        q = -0.5 * (h1 + np.copysign(np.sqrt(discriminant), h1))
        guesses = sorted((q / h2, h0 / q) if q != 0.0 else (0.0, 0.0))
        found = [self._polished(s, w, v) for w in guesses]
        if any(w is None for w in found):
            return None
        low, high = sorted(w for w in found if w is not None)
        return (low, high) if high - low > 0.1 * (guesses[1] - guesses[0]) else None

    def _polished(self, s: float, w: float, v: Array) -> float | None:
        for _ in range(BUDGET):
            value = self.reduced(s, w, v)
            if value is None or value[1] == 0.0:
                return None
            h, slope, v = value
            w -= h / slope
            if abs(h / slope) < 1e-10 * abs(w) + SETTLED:
                return w
        return w

    def point(self, s: float, w: float) -> Array | None:
        """The point y + s t + w e + v."""
        value = self.reduced(s, w, np.zeros(len(self.y)))
        return None if value is None else self.y + s * self.tangent + w * self.across + value[2]

    def contact(self) -> int | None:
        """The order m of |w2 - w1| ~ s^m on both sides; None where there are no two branches, or it is unclear."""
        orders = [self._order(side) for side in (-1.0, 1.0)]
        return orders[0] if orders[0] == orders[1] else None

    def _order(self, side: float) -> int | None:
        gaps = []
        for s in DISTANCES:
            pair = self.roots(side * s)
            if pair is None or pair[1] - pair[0] < RESOLVED:
                break
            gaps.append(pair[1] - pair[0])
        exponents = -np.diff(log2(np.array(gaps))) if len(gaps) >= 2 else np.empty(0)
        if not exponents.size:
            return None
        last = float(exponents[-1])
        return round(last) if abs(last - round(last)) < WHOLE and round(last) >= 2 else None

    def beside(self, own: Array) -> dict[int, tuple[Array, Array]]:
        """Points (on the branch through `own`, on the other one) by the side of t that they lie on."""
        offset = own - self.y
        s, w = float(self.tangent @ offset), float(self.across @ offset)
        order = self.contact()
        side = 1.0 if s >= 0.0 else -1.0
        at_own = self.roots(s)
        if order is None or at_own is None:
            return {}
        upper = abs(w - at_own[1]) < abs(w - at_own[0])  # the branch at hand is the upper one there
        found = {}
        for sign in (side, -side):
            distance = next((d for d in DISTANCES[2:] if self._gap(sign * d) >= TOLD_APART), DISTANCES[1])
            pair = self.roots(sign * distance)
            if pair is None:
                continue
            high = upper != (sign != side and order % 2 == 1)
            points = [self.point(sign * distance, pair[int(k)]) for k in (high, not high)]
            if points[0] is not None and points[1] is not None:
                found[int(sign)] = (points[0], points[1])
        return found

    def _gap(self, s: float) -> float:
        pair = self.roots(s)
        return 0.0 if pair is None else pair[1] - pair[0]
