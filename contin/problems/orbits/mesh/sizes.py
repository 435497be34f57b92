"""Typical sizes of the states on an orbit, in which its lengths are measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.mesh.layout import Profile
from contin.simulate.natural import beyond_rounding, filled
from contin.simulate.natural import sizes_of as usual_sizes

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

TINY_STATE: Final = 1e-6  # a state this small beside the others may be zero with rounding errors


def state_sizes(family: FamilyOfOrbits, profile: Profile) -> Array:
    """(n,) the largest modulus of every state, an angle's period / (2 pi).

    A state that is zero, up to rounding, is taken to be as large as the coupling to the other states makes it; where
    nothing is coupled to it, as the largest of them: a mere 1 would depend on the units. (One that moves the others
    in a period is no zero, and has its own size.) Of an orbit at rest in the origin (a forced one) the states are as
    large as in the model's starts.
    """
    usual = usual_sizes(family.system.model, tuple(float(v) for v in family.base))[1]
    largest = beyond_rounding(np.abs(profile.u).max(axis=0), usual)
    largest = largest if largest.any() else usual
    periods = family.state_periods
    largest = np.where(periods > 0.0, periods / (2.0 * np.pi), largest)
    small = largest <= TINY_STATE * float(largest.max())
    if small.any():
        coupling = _coupling(family, profile)
        usual, guessed = filled(np.where(small, 0.0, largest), coupling)
        unseen = np.where(_noticed(largest, small, coupling, profile.period), largest, largest.max() or usual)
        usual = np.where(guessed, unseen, usual)
        largest = np.where(small & (largest < TINY_STATE * usual), usual, largest)
    return np.asarray(largest)


def _noticed(largest: Array, small: NDArray[np.bool_], coupling: Array, period: float) -> NDArray[np.bool_]:
    """Which states move one whose size is known by a noticeable part of it in a period, at once or by others, (n,)."""
    moved = coupling * largest * period * (1.0 - np.eye(len(largest)))  # of a row's state, by a column's
    known = ~small
    for _ in largest:
        known = known | np.any((moved > TINY_STATE * largest[:, None]) & known[:, None], axis=0)
    return known


def _coupling(family: FamilyOfOrbits, profile: Profile) -> Array:
    """Mean modulus of the Jacobian along an orbit, (n, n)."""
    n, p = profile.n, family.full_parameters(profile.vector())
    total = np.zeros((n, n))
    for u in profile.u[:: profile.m]:
        _, jacobian = family.system.jacobian(u, p)
        total += np.nan_to_num(np.abs(jacobian[:, :n]), posinf=0.0)
    return total / len(profile.h)
