"""Families that leave a family of orbits found by shooting: at branch points and at period doublings.

At a branch point the direction of the crossing family is found by following it: an orbit is solved for at a distance
along the null vector that is not the family's own. That needs no second derivatives, which a return map with corners
does not have.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation import march as generic
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.linear import family_tangents
from contin.problems.shooting.sampling import flights, states

DISTANCES = (1e-2, 3e-3, 1e-3)  # (arclength) at which the crossing family is looked for
OFF = 0.05  # sine of the angle to the family's own tangent below which the orbit found is one of that family


def switch(problem: Any, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the families born at a BPC (the crossing one) or a PD (the doubled orbits), with `parameter` free."""
    if parameter != problem.parameters[0]:
        raise InputError(
            f"{point.branch}.{point.label}: a new family starts along {problem.parameters[0]}; vary another parameter "
            "from one of its orbits"
        )
    if point.type == "BPC":
        return [_crossing(problem, point)]
    if point.type == "PD":
        return [_doubled(problem, point)]
    raise InputError(
        f"{point.branch}.{point.label}: another family of orbits starts at BPC and PD only; this is {point.type}"
    )


def _crossing(problem: Any, point: SpecialPoint) -> Seed:
    raw = np.where(point.tangent == 0.0, 0.0, point.tangent / point.scale)
    own = raw / np.linalg.norm(raw)
    found = crossing(problem, point.z, own, point.scale, 1)
    if found is None:
        raise InputError(f"{point.branch}.{point.label}: no second real family was found nearby")
    other = crossing(problem, point.z, own, point.scale, -1)
    alike = other is not None and _images(problem, found[1], other[1])
    direction = found[0]
    halves: tuple[int, ...] = (1,) if alike or other is None else (-1, 1)
    if direction[-1] < 0.0 and len(halves) == 2:
        direction = -direction
    return Seed(
        problem, point.z, direction, None, point.scale, halves, Parent(point.branch, point.label),
        measured=(int(np.sum(np.abs(point.eigenvalues) > 1.0 + 1e-4)), point.eigenvalues),
    )  # fmt: skip


def crossing(problem: Any, z: Array, own: Array, scale: Array, sense: int) -> tuple[Array, Array] | None:
    """(unit direction, orbit) of the family that crosses at z, on one side of the null vector normal to `own`."""
    plane = family_tangents(problem, z, scale)
    if len(plane) < 2:
        return None
    across = _normal_part(plane, own)
    for distance in DISTANCES:
        guess = sense * distance * across
        found = generic.correct(problem, z, across, sense * distance, guess, scale, 1e-10)
        if isinstance(found, str):
            continue
        direction = found.y / float(np.linalg.norm(found.y))
        if np.linalg.norm(direction - (direction @ own) * own) > OFF and abs(found.y @ across) > 0.5 * distance:
            return direction, found.z
    return None


def _normal_part(plane: Any, own: Array) -> Array:
    """Unit vector of the plane normal to `own`."""
    first, second = plane
    a, b = float(first @ own), float(second @ own)
    across = b * first - a * second
    size = float(np.linalg.norm(across))
    return np.asarray(across / size) if size > 1e-6 else np.asarray(second)


def side_of_branch(problem: Any, z: Array, scale: Array) -> Mapping[str, Any]:
    """{kind, side}: pitchfork or transcritical, nonsmooth where the orbit has corners, and where the new orbits lie."""
    plane = family_tangents(problem, z, scale)
    if len(plane) < 2:
        return {}
    own = np.asarray(plane[0])
    moved = []
    for sense in (1, -1):
        found = crossing(problem, z, own, scale, sense)
        if found is not None:
            moved.append((float(found[1][-1] - z[-1]), found[1]))
    if not moved:
        return {}
    nonsmooth = any(f.crossed for f in flights(problem, z, np.empty(0)))
    form: dict[str, Any] = {"kind": "nonsmooth"} if nonsmooth else {}
    signs = {np.sign(m) for m, _ in moved}
    if len(moved) == 2 and len(signs) == 2 and not _images(problem, moved[0][1], moved[1][1]):
        form.setdefault("kind", "transcritical")
        return form
    form.setdefault("kind", "pitchfork")
    form["side"] = "above" if moved[0][0] > 0.0 else "below"
    return form


def _images(problem: Any, a: Array, b: Array) -> str | None:
    """The declared symmetry that maps one orbit (as a set) onto the other."""
    times = np.linspace(0.0, 1.0, 65)[:-1]
    u, v = states(problem, a, times), states(problem, b, times)
    reference = max(float(np.ptp(u, axis=0).max()), 1e-12)
    apart = float(np.abs(u - v).max())
    p = problem.full_parameters(a)
    for symmetry in problem.system.model.symmetries:
        image = problem.system.symmetry(symmetry.name, np.ascontiguousarray(u), p)
        for shift in (0, 32):
            if float(np.abs(np.roll(image, shift, axis=0) - v).max()) < 0.1 * apart + 1e-9 * reference:
                return str(symmetry.name)
    return None


def _doubled(problem: Any, point: SpecialPoint) -> Seed:
    """The doubled orbits: twice the segments, along the eigenvector of the multiplier -1."""
    nodes, n = Nodes.of(point.z, problem.n), problem.n
    segments = problem.segments(point.z)
    monodromy = np.eye(n)
    for matrix in segments.transitions:
        monodromy = matrix @ monodromy
    values, vectors = np.linalg.eig(monodromy)
    v = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    moved = [v]
    for matrix in segments.transitions[:-1]:
        moved.append(matrix @ moved[-1])
    half = np.array(moved)
    u = np.vstack([nodes.u, nodes.u + problem.winding])
    doubled = replace(nodes, u=u, period=2.0 * nodes.period)
    sizes = problem.sizes(point.z, point.scale)
    scale = make_scale(sizes, 2 * nodes.count, 2.0 * float(point.scale[-n - 3]), float(point.scale[-1]))
    direction = np.zeros(len(scale))
    direction[: u.size] = np.vstack([half, -half]).ravel() / scale[: u.size]
    direction /= np.linalg.norm(direction)
    family = replace(
        problem, count=2 * nodes.count, winding=2.0 * problem.winding, multiple=2 * problem.multiple
    )
    return Seed(
        family, doubled.vector(), direction, None, scale, (1,), Parent(point.branch, point.label),
        measured=(int(np.sum(np.abs(point.eigenvalues) > 1.0 + 1e-4)), np.asarray(point.eigenvalues) ** 2),
    )  # fmt: skip
