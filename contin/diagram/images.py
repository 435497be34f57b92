"""Branches that a declared symmetry makes of computed ones: nothing is computed twice."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, End, ImageOf, SpecialPoint
from contin.problems.symmetry import apply_symmetry, every_symmetry, symmetry_names
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

SAME = 1e-7  # relative difference from which two points are two
NEXT_TO_ZERO = 1e-6  # of the scale of an unknown
STEP = 1e-6  # of the difference quotient that maps tangents, relative to the point


def images(branch: Branch) -> list[Branch]:
    """The mirror images of a branch that was computed on one side of the point where it broke a symmetry.

    A branch that began elsewhere has none: it may be its own image, and was not asked to show what others are.
    Symmetries that have the same image there (a group of several) give one branch, named after the first.
    """
    declared = symmetry_names(branch.problem) if branch.parent is not None else ()
    candidates = [image(branch, name) for name in branch.symmetries if name in declared]
    if len(candidates) < 2:
        return candidates
    scales = _scales(branch)
    found: list[Branch] = []
    for candidate in candidates:
        if not any(_are_alike(candidate.z, other.z, scales) for other in found):
            found.append(candidate)
    return found


def images_through(branch: Branch, z: Array, known: Iterable[Branch]) -> list[Branch]:
    """Images of a computed branch that contain the point z and are not among the `known` branches.

    Where symmetries map several branches through a point onto each other, one is computed and these are the rest.
    """
    found: list[Branch] = []
    size = np.maximum(np.abs(branch.z), NEXT_TO_ZERO * _scales(branch))
    for name in every_symmetry(branch.problem):
        mapped = apply_symmetry(branch.problem, name, branch.z)
        others = [b.z for b in (*known, *found) if b.z.shape == mapped.shape]
        if any(np.all(np.abs(mapped - rows) <= SAME * size) for other in others for rows in (other, other[::-1])):
            continue
        if np.any(np.all(np.abs(mapped - z) <= SAME * np.maximum(size, np.abs(z)), axis=1)):
            found.append(image(branch, name))
    return found


def _are_alike(a: Array, b: Array, scales: Array) -> bool:
    known = np.isfinite(a) & np.isfinite(b)
    same = np.abs(a - b) <= SAME * np.maximum(np.abs(b), scales)
    return bool(np.all(same | ~known) and np.array_equal(np.isfinite(a), np.isfinite(b)))


def _scales(branch: Branch) -> Array:
    """Of the unknowns, in the metric of the branch's problem at its ends and middle: 1e-15 and -1e-15 may be two."""
    z = branch.z
    bounds = float(np.nanmin(z[:, -1])), float(np.nanmax(z[:, -1]))
    rows = (row for row in (z[0], z[len(z) // 2], z[-1]) if np.all(np.isfinite(row)))
    scales = [branch.problem.initial_scale(row, bounds) for row in rows]
    return np.asarray(np.max(scales, axis=0)) if scales else np.nanmax(np.abs(z), axis=0)


def image(branch: Branch, symmetry: str) -> Branch:
    """`branch` with every row, tangent and labelled point mapped by a declared symmetry."""
    problem = branch.problem
    z = apply_symmetry(problem, symmetry, branch.z)
    columns: Fields = dict(problem.columns(z))
    columns |= {key: branch.columns[key] for key in ("unstable", "stable")}
    tangents = _mapped_tangents(problem, symmetry, branch.z, branch.tangents)
    name = f"{branch.name}~{symmetry}"
    points = tuple(_mapped_point(p, name, z, tangents, columns) for p in branch.points)
    ends = tuple(_mapped_end(end) for end in branch.ends)
    return replace(
        branch, name=name, columns=columns, points=points, ends=(ends[0], ends[1]), z=z, tangents=tangents, steps=0,
        seconds=0.0, effort={}, image_of=ImageOf(branch.name, symmetry), notes=(), symmetries=(),
    )  # fmt: skip


def _mapped_tangents(problem: EquilibriumProblem, symmetry: str, z: Array, tangents: Array) -> Array:
    size = np.nanmax(np.abs(z), axis=1, keepdims=True) / np.maximum(
        np.nanmax(np.abs(tangents), axis=1, keepdims=True), 1e-300
    )
    h = STEP * np.maximum(size, 1e-12)
    forward, backward = (
        apply_symmetry(problem, symmetry, z + h * tangents),
        apply_symmetry(problem, symmetry, z - h * tangents),
    )
    return np.asarray((forward - backward) / (2.0 * h))


def _mapped_point(point: SpecialPoint, branch: str, z: Array, tangents: Array, columns: Fields) -> SpecialPoint:
    row = point.index
    values = dict(point.values) | {key: column[row].item() for key, column in columns.items()}
    return replace(point, z=z[row], tangent=tangents[row], values=values, branch=branch)


def _mapped_end(end: End) -> End:
    return replace(end, data={k: v for k, v in end.data.items() if k not in ("saddle", "saddles")})
