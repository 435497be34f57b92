"""Typical sizes of the states on an orbit, in which its lengths are measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.balancing import balancing_scales
from contin.problems.orbits.mesh.layout import Profile
from contin.simulate.natural import BENDS_UP_TO, filled, growth_lengths, pure_derivatives

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

TINY_STATE: Final = 1e-6  # a state this small beside the others may be zero with rounding errors


def state_sizes(family: FamilyOfOrbits, profile: Profile) -> Array:
    """(n,) the largest modulus of every state, an angle's period / (2 pi).

    A state that is zero, up to rounding, is taken to be as large as the coupling to the other states makes it; where
    nothing is coupled to it, as the length over which its equations bend; where they are linear, as the largest of the
    others, and states that act on each other in the ratio that balances this. A mere 1 would depend on the units.
    """
    largest = np.abs(profile.u).max(axis=0)
    periods = family.state_periods
    largest = np.where(periods > 0.0, periods / (2.0 * np.pi), largest)
    small = largest <= TINY_STATE * float(largest.max())
    if small.any():
        size, coupling = np.where(small, 0.0, largest), _coupling(family, profile)
        usual, guessed = filled(size, coupling)
        if guessed.any() and profile.n <= BENDS_UP_TO:
            second, lengths = _bending(family, profile, coupling)
            usual, guessed = filled(np.where(guessed & (size == 0.0), lengths, size), coupling, second, lengths)
        if guessed.any():
            ratios = balancing_scales(coupling[np.ix_(guessed, guessed)])
            usual[guessed] = (largest.max() or 1.0) * ratios / ratios.max()
        largest = np.where(small & (largest < TINY_STATE * usual), usual, largest)
    return np.asarray(largest)


def _coupling(family: FamilyOfOrbits, profile: Profile) -> Array:
    """Mean modulus of the Jacobian along an orbit, (n, n)."""
    n, p = profile.n, family.full_parameters(profile.vector())
    total = np.zeros((n, n))
    for u in profile.u[:: profile.m]:
        _, jacobian = family.system.jacobian(u, p)
        total += np.nan_to_num(np.abs(jacobian[:, :n]), posinf=0.0)
    return total / len(profile.h)


def _bending(family: FamilyOfOrbits, profile: Profile, coupling: Array) -> tuple[Array, Array]:
    """Largest |d^2 F_k / d u_i^2| along an orbit, (n, n), and over which lengths equations bend in each state, (n,)."""
    p = family.full_parameters(profile.vector())
    parts = [pure_derivatives(family.system, u, p) for u in profile.u[:: profile.m]]
    second, third = (np.max([part[k] for part in parts], axis=0) for k in (0, 1))
    return second, growth_lengths(coupling, second, third)
