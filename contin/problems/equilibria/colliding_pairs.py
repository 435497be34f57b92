"""Two pairs of eigenvalues that meet on the stability boundary and leave it: the Hamiltonian Hopf bifurcation.

Where an energy is kept or time can be reversed, l and -conj(l) (maps: 1 / conj(l)) are eigenvalues together. Pairs on
the boundary leave it where two of opposite Krein signature meet; the double pair has one eigenvector only, and the two
become l and its mate (Meyer and Offin, Introduction to Hamiltonian Dynamical Systems, ch. 11).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Vector
from contin.continuation.outcome import Rejected
from contin.machine import elementary

MEETING: Final = 1e-2  # two pairs this close beside their size may meet
MATES: Final = 0.1  # ... each mirrored at the boundary is one of them to this part of their distance


def colliding(values: Vector, pair: complex, by_multipliers: bool) -> Rejected | None:
    """What to say instead of a Hopf or Neimark-Sacker point where the pair next to `pair` is about to meet it.

    Beside such a place the two are mates, or both on the boundary, and nearly equal.
    """
    mates = 1.0 / np.conj(values) if by_multipliers else -np.conj(values)
    upper = np.flatnonzero(values.imag > 0.0)
    if len(upper) < 2:
        return None
    first, second = upper[np.argsort(np.abs(values[upper] - pair))[:2]]
    both = values[[first, second]]
    apart = abs(both[0] - both[1])
    off = max(np.abs(mates[first] - both).min(), np.abs(mates[second] - both).min())
    if not (apart < MEETING * abs(pair) and off < MATES * apart):
        return None
    what, where, at = (
        ("multipliers", "unit circle", f"exp(+-{float(elementary.angle(pair)):.6g} i)") if by_multipliers
        else ("eigenvalues", "imaginary axis", f"+-{abs(pair.imag):.6g} i")
    )  # fmt: skip
    return Rejected(
        f"two pairs of {what} meet on the {where} at {at} and leave it to both sides (a Hamiltonian Hopf bifurcation, "
        "as where an energy is kept or time can be reversed): no label is made of it"
    )
