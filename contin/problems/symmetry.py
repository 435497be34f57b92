"""Declared symmetries of a model, applied to points and tangents of its equilibria."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from contin.abi import Array
from contin.problems.symmetry_group import group_words
from contin.systems.iterate import IteratedSystem

if TYPE_CHECKING:
    from contin.problems.contracts import HasSystem, InOneParameter

STEP = 1e-4  # of the finite difference along a direction (relative to the direction's own length)
CYCLE_STEP = 1e-6  # the same of a cycle's points, which iterates drive apart
AGREES = 1e-5


@runtime_checkable
class OrbitMaps(Protocol):
    """Problems whose unknowns are whole orbits map them themselves."""

    def moved(self, name: str, z: Array) -> Array:
        """Images of rows z."""


def symmetry_names(problem: HasSystem) -> tuple[str, ...]:
    """The declared symmetries, then their products in pairs (`a*b`: first b, then a): those a branch is named after.

    What is the same up to symmetry is decided by all of them, `every_symmetry`.
    """
    declared = tuple(s.name for s in problem.system.model.symmetries)
    return declared + tuple(f"{a}*{b}" for a in declared for b in declared if a != b)


def every_symmetry(problem: HasSystem) -> tuple[str, ...]:
    """The group that the declared symmetries generate without the identity: those first, then longer products."""
    return group_words(problem.system)


def apply_symmetry(problem: InOneParameter, name: str, z: Array) -> Array:
    """Images of rows z (k, n + 1) under a name of `symmetry_names`: the state part is mapped, the parameter stays."""
    if "*" in name:
        outer, inner = name.split("*", 1)
        return apply_symmetry(problem, outer, apply_symmetry(problem, inner, z))
    z = np.atleast_2d(z)
    if isinstance(problem, OrbitMaps):
        return problem.moved(name, z)
    mapped = z.copy()
    p = np.tile(problem.base, (len(z), 1))
    p[:, problem.active] = z[:, -1]
    mapped[:, :-1] = problem.system.symmetry(name, np.ascontiguousarray(z[:, :-1]), p)
    return mapped


def reversing_symmetries(problem: InOneParameter, z: Array, direction: Array, scale: Array) -> tuple[str, ...]:
    """Symmetries that keep z (modulo angle periods) and turn `direction` (unscaled, (n + 1,)) round.

    scale : of the unknowns, the metric in which both are judged.

    At a branch point they map one half of the new branch onto the other: the point breaks them. A cycle of a map is
    kept by a symmetry that shifts it, too.
    """
    names = symmetry_names(problem)
    found = []
    lengths = np.abs(direction / scale)
    size = float(np.max(lengths[:-1], initial=0.0))
    if size == 0.0 or lengths[-1] > AGREES * float(lengths.max()):
        return ()
    step = STEP if not isinstance(problem.system, IteratedSystem) else CYCLE_STEP
    for name in names:
        rows = apply_symmetry(problem, name, np.stack([z, z + step * direction, z - step * direction]))
        for image in _shifts(problem, rows):
            fixed = _wrapped(image[0] - z, problem.angle_periods)
            if np.any(np.abs(fixed) > AGREES * np.maximum(np.abs(z), size * scale)):
                continue
            moved = _wrapped(image[1] - image[2], problem.angle_periods) / (2.0 * step)
            if np.all(np.abs(moved[:-1] + direction[:-1]) <= AGREES * size * scale[:-1]):
                found.append(name)
                break
    return tuple(found)


def _shifts(problem: InOneParameter, rows: Array) -> Iterator[Array]:
    """Rows (k, n + 1), and of an iterated map the same cycles from their other points."""
    yield rows
    if isinstance(problem.system, IteratedSystem):
        orbits = [list(problem.system.orbit(z[:-1], problem.full_parameters(z))) for z in rows]
        for j in range(1, problem.system.times):
            yield np.array([np.append(orbit[j], z[-1]) for orbit, z in zip(orbits, rows, strict=True)])


def _wrapped(difference: Array, periods: Array) -> Array:
    wrapped = difference.copy()
    angles = np.flatnonzero(periods)
    wrapped[angles] -= periods[angles] * np.round(difference[angles] / periods[angles])
    return wrapped
