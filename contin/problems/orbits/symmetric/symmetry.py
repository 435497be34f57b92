"""Declared symmetries acting on periodic orbits: which orbits they keep as sets, and which families they map to others.

A symmetry S keeps an orbit as a set where S u(x) = u(x + shift); for a symmetry of order two the shift is 0 (every
point of the orbit is kept) or half a period. A family that breaks it at a branch point has two halves, S-images of each
other.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.location.halting import HALF_PERIOD
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.symmetry import every_symmetry, symmetry_names
from contin.problems.symmetry_group import cut_off, moved

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

ALIKE = 1e-3  # difference (relative to the orbit's extent) up to which two orbits are one
TURNED = 1e-2  # ... and two directions opposite
STEP = 1e-4  # of the difference quotient that maps directions


def states_moved(problem: OrbitEquations, name: str, u: Array, p: Array) -> Array:
    """Images of states u (K, n) under a declared symmetry, or a product `a*b` (first b)."""
    return moved(problem.system, name, u, p)


def orbits_moved(problem: OrbitEquations, name: str, z: Array) -> Array:
    """Rows z (k, size), padded on the left with NaN as those of a branch, with every state mapped."""
    rows = np.array(z, dtype=float)
    for row in rows:
        first = int(np.argmax(~np.isnan(row)))
        orbit = row[first:]
        size = problem.profile(orbit).u.size
        states = states_moved(problem, name, orbit[:size].reshape(-1, problem.n), problem.full_parameters(orbit))
        orbit[:size] = states.ravel()
    return rows


def shifted(problem: OrbitEquations, u: Profile, fraction: float) -> Array:
    """u(x + fraction) at the nodes of u, (K, n); what angles gained in a period is added after it."""
    times = u.times + fraction
    turns = np.floor(times)
    return np.asarray(u.at(times - turns) + turns[:, None] * problem.winding)


def symmetry_of(problem: OrbitEquations, z: Array) -> tuple[str, float] | None:
    """A declared symmetry that keeps the orbit as a set: its name and the shift (0 or half a period)."""
    profile = problem.profile(z)
    p = problem.full_parameters(z)
    for name in symmetry_names(problem):
        for fraction in (0.0, 0.5):
            if _apart(problem, states_moved(problem, name, shifted(problem, profile, fraction), p), profile) < ALIKE:
                return name, fraction
    return None


def symmetrised(problem: OrbitEquations, z: Array) -> Array:
    """z with the mean of its images under the symmetries that keep every point of the orbit, to what they map it by.

    Where symmetry makes several multipliers 1 Newton's method finds an orbit off their fixed space by the root of its
    residual. As it is, where the group is not known as a whole.
    """
    if cut_off(problem.system):
        return z
    profile, p = problem.profile(z), problem.full_parameters(z)
    images = (states_moved(problem, name, profile.u, p) for name in every_symmetry(problem))
    away = [_difference(problem, image, profile) for image in images]
    size = ALIKE * max(float(np.ptp(profile.u, axis=0).max()), 1e-12)
    kept = [d for d in away if float(np.abs(d).max()) < size]
    return replace(profile, u=profile.u + sum(kept) / (len(kept) + 1)).vector() if kept else z


def halves_alike(problem: OrbitEquations, z: Array, direction: Array) -> tuple[str, ...]:
    """The symmetries, with or without a shift by half a period, that keep the orbit and turn the raw `direction` round.

    At a branch point the two halves of the new family are then images of each other.
    """
    return tuple(name for name in symmetry_names(problem) if reverses(problem, z, direction, name))


def reverses(problem: OrbitEquations, z: Array, direction: Array, name: str) -> bool:
    """True where the symmetry `name` keeps the orbit and turns the raw `direction` (like z) round.

    HALF_PERIOD: true where the orbit has half the period and the shift turns the direction round.
    """
    change = _states_of(problem, z, direction)
    size = float(np.abs(change).max())
    if size == 0.0:
        return False
    for fraction in (0.5,) if name == HALF_PERIOD else (0.0, 0.5):
        image = moved_direction(problem, z, direction, name, fraction)
        if image is not None and float(np.abs(image + change).max()) < TURNED * size:
            return True
    return False


def moved_direction(problem: OrbitEquations, z: Array, direction: Array, name: str, fraction: float) -> Array | None:
    """States (K, n) of the image of a raw direction (like z) under a symmetry and a shift by `fraction` of a period.

    None where these do not keep the orbit.
    """
    profile = problem.profile(z)
    change = _states_of(problem, z, direction)
    step = STEP / float(np.abs(change).max()) * max(float(np.ptp(profile.u, axis=0).max()), 1e-12)
    p = problem.full_parameters(z)
    images = []
    for sign in (0.0, step, -step):
        bent = shifted(problem, replace(profile, u=profile.u + sign * change), fraction)
        images.append(bent - 0.5 * problem.winding if name == HALF_PERIOD else states_moved(problem, name, bent, p))
    if not _apart(problem, images[0], profile) < ALIKE:
        return None
    return np.asarray((images[1] - images[2]) / (2.0 * step))


def _states_of(problem: OrbitEquations, z: Array, direction: Array) -> Array:
    """The states' part of a raw direction (like z), (K, n)."""
    profile = problem.profile(z)
    moved = direction.copy()
    moved[profile.u.size + 1 : -1] = profile.h
    return np.asarray(problem.profile(moved).u)


def _apart(problem: OrbitEquations, u: Array, profile: Profile) -> float:
    """Distance of states at the nodes from the orbit's, relative to its extent; whole turns of angles do not count."""
    difference = _difference(problem, u, profile)
    return float(np.abs(difference).max()) / max(float(np.ptp(profile.u, axis=0).max()), 1e-12)


def _difference(problem: OrbitEquations, u: Array, profile: Profile) -> Array:
    """States at the nodes less the orbit's, without whole turns of angles."""
    difference = u - profile.u
    periods = np.asarray(problem.system.model.periods(problem.constants()), dtype=float)
    turns = np.where(periods > 0.0, np.mean(difference, axis=0) / np.where(periods > 0.0, periods, 1.0), 0.0)
    return np.asarray(difference - np.round(turns) * periods)
