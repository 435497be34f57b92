"""Multipliers of an orbit: the trivial one of an autonomous system, those that are critical, and the others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.kernels.special_orbits.tests import BESIDE
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits


Multipliers = NDArray[np.complex128]

TOGETHER = 1e-7  # distance of eigenvalues at a Hopf point, relative to omega, up to which they cross together


def nontrivial(problem: FamilyOfOrbits, values: Multipliers) -> Multipliers:
    """Without the trivial one of an autonomous system, which stands first."""
    return values[1:] if problem.autonomous else values


def of_rest(values: Multipliers, omega: float, period: float) -> tuple[int, Multipliers]:
    """Of a Hopf point with these eigenvalues, as an orbit: how many are unstable beside the pair +-i omega, or several
    such pairs that cross together, and multipliers exp(l T), 1 twice first."""
    order = np.argsort(np.minimum(np.abs(values - 1j * omega), np.abs(values + 1j * omega)))
    others = values[order[2:]]
    with np.errstate(over="ignore"):
        multipliers = np.concatenate([[1.0, 1.0], elementary.exp(others * period)]).astype(complex)
    together = np.minimum(np.abs(others - 1j * omega), np.abs(others + 1j * omega)) <= TOGETHER * omega
    return int(np.sum((others.real > 0.0) & ~together)), multipliers


def critical(type_: str, theta: float) -> tuple[complex, ...]:
    """The multipliers that are on the unit circle at a special orbit; of NS exp(+-i theta)."""
    if type_ == "NS":
        return complex(elementary.exp(1j * theta)), complex(elementary.exp(-1j * theta))
    return (-1.0,) if type_ == "PD" else (1.0,)


def distance(values: Multipliers, targets: Sequence[complex]) -> float:
    """The largest distance of a target from the nearest multiplier; inf without multipliers."""
    return float(max(np.min(np.abs(values - target), initial=np.inf) for target in targets))


def _apart(values: Multipliers, target: complex) -> NDArray[np.float64]:
    """How far each is from a target, in an order that is that of |log values/target|: multipliers may vanish."""
    sizes = np.abs(values)
    squares = np.square((values - target).real) + np.square((values - target).imag)
    far: NDArray[np.float64] = np.full(len(values), np.inf)
    np.divide(squares, sizes, out=far, where=sizes > 0.0)
    return far


def nearest(values: Multipliers, target: complex) -> int:
    """Place of the multiplier nearest to a target."""
    return int(np.argmin(_apart(values, target)))


def without(values: Multipliers, targets: Sequence[complex]) -> Multipliers:
    """Without the multiplier nearest to each of the targets."""
    left = list(values)
    for target in targets:
        if left:
            left.pop(nearest(np.array(left), target))
    return np.array(left, complex)


def without_critical(values: Multipliers, critical: float) -> Multipliers:
    """Without the one that is `critical` (1 or -1) along a curve.

    One next to it is known to rounding / its distance from that, their sum to rounding: where both are real or a pair
    it is their sum less `critical`, which is smooth where they meet (R1, R2).
    """
    if not len(values):
        return values
    order = np.argsort(_apart(values, critical))
    left = values[order[1:]]
    near = len(left) and abs(left[0] - critical) <= BESIDE
    if near and left[0].imag in (0.0, -values[order[0]].imag):
        left[0] = (values[order[0]] + left[0]).real - critical
    return left
