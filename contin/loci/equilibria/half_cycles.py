"""Curves of cycles of maps that come to cycles of half the period: of tori at R2 of these, of folds at their GPD."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeGuard

import numpy as np

from contin.abi import Array
from contin.systems.iterate import IteratedSystem, iterate, sizes_along
from contin.systems.protocol import System

OPPOSITE: Final = 0.9  # cosine of the ways from one half to the other of neighbouring cycles that have changed places
NEAR: Final = 0.05  # relative distance of the halves, and of a multiplier from -1, of a cycle that is about to be one


def is_even(system: System) -> TypeGuard[IteratedSystem]:
    """Whether the fixed points of a system are cycles with two halves."""
    return isinstance(system, IteratedSystem) and system.times % 2 == 0


def halves_change_places(system: IteratedSystem, u: Array, p: Sequence[Array]) -> int | None:
    """The first row of cycles u (N, n) whose halves stand where those of the row before stood, exchanged.

    p : the parameters of each (m,).

    Between the two rows the halves were the same.
    """
    apart = _apart(system, u, p)
    size = np.abs(apart).max(axis=0)
    apart = apart / np.where(size > 0.0, size, 1.0)
    lengths = np.sqrt(np.sum(apart * apart, axis=1))
    cosines = np.sum(apart[1:] * apart[:-1], axis=1)
    turned = np.flatnonzero(cosines < -OPPOSITE * lengths[1:] * lengths[:-1])
    return int(turned[0]) + 1 if len(turned) else None


def is_doubling(system: System, u: Array, p: Array) -> bool:
    """Whether the cycle from u (n,) is one of half its period, which has a multiplier -1, but for small differences."""
    if not is_even(system):
        return False
    half = iterate(system.base, system.times // 2)
    apart = np.abs(half.value(u, p) - u) / sizes_along(system, u, p)
    multipliers = np.linalg.eigvals(half.jacobian(u, p)[1][:, : len(u)])
    return bool(np.max(apart) < NEAR and np.min(np.abs(multipliers + 1.0)) < NEAR)


def _apart(system: IteratedSystem, u: Array, p: Sequence[Array]) -> Array:
    """From each cycle's first point to the one half a period later."""
    half = iterate(system.base, system.times // 2)
    return np.array([half.value(x, others) - x for x, others in zip(u, p, strict=True)])
