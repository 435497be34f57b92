"""Values on lines through the last point, which derivatives of several orders and along several directions share.

D^k F[v, .., v] along -v, i v and conj v is that along v but for a factor, or its conjugate: F is real at real points.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array, Vector

MOST: Final = 2_000_000  # complex numbers that are kept (32 MB)
AROUND: Final = 16  # values on a line


@dataclass(frozen=True, eq=False)
class Line:
    """D^k F along a direction is factor^k times that along `v`, or its conjugate."""

    v: Vector  # real where the derivative is that along a real direction
    factor: complex
    conjugate: bool

    @classmethod
    def along(cls, v: Vector) -> Line:
        """The one of those with the same derivatives that is evaluated: real where that will do."""
        factor: complex = 1.0
        if np.iscomplexobj(v):
            if not v.imag.any():
                v = v.real
            elif not v.real.any():
                v, factor = v.imag, 1j
        lead = v[np.flatnonzero(v)[0]]
        if lead.real < 0.0 or (lead.real == 0.0 and lead.imag < 0.0):
            v, factor = -v, -factor
        v = v + 0.0  # -0.0 becomes 0.0: one key for each
        if not np.iscomplexobj(v):
            return cls(v, factor, False)
        below = bool(v.imag[np.flatnonzero(v.imag)[0]] < 0.0)
        return cls(v.conj() + 0.0 if below else v, factor, below)

    def turned(self, found: Vector, order: int) -> Vector:
        """The derivative along the direction itself, given that along `v`."""
        found = found.conj() if self.conjugate else found
        power: complex = 1.0
        for _ in range(order):
            power = power * self.factor
        return found * (power if np.iscomplexobj(power) and power.imag != 0.0 else power.real)


@dataclass(eq=False)
class KnownLines:
    """t -> F(z + t v) by the bytes of v, at one z."""

    _place: tuple[bytes, bytes] | None = None
    _lines: dict[bytes, dict[complex, Vector]] = field(default_factory=dict)

    def on(self, u: Array, p: Array, v: Vector) -> dict[complex, Vector]:
        """What is known on the line through (u, p) along v, to be added to."""
        place, key = (u.tobytes(), p.tobytes()), v.tobytes()
        if place != self._place:
            self._place, self._lines = place, {}
        if key not in self._lines:
            while self._lines and (len(self._lines) + 1) * AROUND * len(u) > MOST:
                del self._lines[next(iter(self._lines))]
            self._lines[key] = {}
        return self._lines[key]
