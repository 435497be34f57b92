"""The family that crosses a family of orbits found by shooting at a branch point.

Its direction is found by following it: an orbit is solved for at a distance
along the null vector that is not the family's own. That needs no second derivatives, which a return map with corners
does not have.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.outcome import Failure
from contin.machine import elementary
from contin.problems.shooting.linear import family_tangents
from contin.problems.shooting.sampling import flights, states
from contin.records import Fields, Record

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

DISTANCES = (1e-3, 3e-3, 3e-4, 1e-2)  # (arclength) at which the crossing family is looked for
SHARP = 1.0  # change of direction within that distance above which it is too far
SAME_OFFSET = 0.3  # relative: two extrapolations that agree so well are of a family that begins elsewhere
ROUNDED = 1e-9  # of the states' sizes: images this near are one
OFF = 0.05  # sine of the angle to the family's own tangent below which the orbit found is one of that family


@dataclass(frozen=True, eq=False)
class Crossing:
    """One half of a family at a branch point: unit direction, curvature (scaled), and one of its orbits."""

    problem: ShotEquations  # of its orbits, with the symmetries they have left
    direction: Array
    curvature: Array
    orbit: Array


def crossing(problem: ShotEquations, z: Array, own: Array, scale: Array, sense: int) -> Crossing | None:
    """The family that crosses at z, on one side of the null vector normal to `own`; None where none is found.

    Two of its orbits, at distances d and d/2, give the direction and the curvature.
    """
    plane = family_tangents(problem, z, scale)
    if len(plane) < 2:
        return None
    across = _normal_part(plane, own)
    left = problem.free().restricted(z + DISTANCES[0] * np.where(across == 0.0, 0.0, across * scale))
    for d in DISTANCES:
        far = _orbit_across(left, z, own, across, scale, sense * d)
        near = _orbit_across(left, z, own, across, scale, sense * d / 2.0)
        if far is None or near is None:
            continue
        along, bend = (4.0 * near - far) / d, 4.0 * (far - 2.0 * near) / elementary.square(d)
        size = float(np.linalg.norm(along))
        if float(np.linalg.norm(bend)) * d > SHARP * size:
            continue
        direction = along / size
        curvature = bend / elementary.square(size)
        curvature = curvature - float(curvature @ direction) * direction
        return Crossing(left, direction, curvature, z + np.where(far == 0.0, 0.0, far * scale))
    return None


def _orbit_across(
    problem: ShotEquations, z: Array, own: Array, across: Array, scale: Array, length: float
) -> Array | None:
    """Scaled offset of the orbit at this length along `across`, which is not one of the family along `own`."""
    found = corrector.correct(problem, z, across, length, length * across, scale, 1e-10)
    if isinstance(found, Failure):
        return None
    size = float(np.linalg.norm(found.y))
    off = float(np.linalg.norm(found.y - (found.y @ own) * own))
    return found.y if off > OFF * size and abs(length) > OFF * size else None


def begins(problem: ShotEquations, z: Array, scale: Array) -> tuple[float, ...]:
    """Parameters at which the two halves of the family that crosses at z begin; () where they do so at z itself.

    Where three or more cells cross a surface together, the derivative of the return map depends on their order: it is
    one matrix for one cell ahead of two, another for two ahead of one, and the multiplier at z belongs to their mean.
    Of orbits at distances d, d/2 and d/4 the first two, and the last two, extrapolated to 0, give the same offset from
    z where there is one, and one a fourth of the other where the family is merely curved.
    """
    plane = family_tangents(problem, z, scale)
    if len(plane) < 2:
        return ()
    own, found = np.asarray(plane[0]), []
    across = _normal_part(plane, own)
    left = problem.free().restricted(z + DISTANCES[0] * np.where(across == 0.0, 0.0, across * scale))
    for sense in (-1.0, 1.0):
        halves = [_orbit_across(left, z, own, across, scale, sense * DISTANCES[0] * part) for part in (1.0, 0.5, 0.25)]
        far, near, next_ = ((h if h is not None else np.full(len(z), np.nan)) for h in halves)
        offset, nearer = 2.0 * near - far, 2.0 * next_ - near
        if not np.linalg.norm(nearer - offset) < SAME_OFFSET * np.linalg.norm(nearer):
            return ()
        found.append(float(z[-1] + scale[-1] * nearer[-1]))
    return tuple(sorted(found))


def _normal_part(plane: Any, own: Array) -> Array:
    """Unit vector of the plane normal to `own`."""
    first, second = plane
    a, b = float(first @ own), float(second @ own)
    across = b * first - a * second
    size = float(np.linalg.norm(across))
    return np.asarray(across / size) if size > 1e-6 else np.asarray(second)


def side_of_branch(problem: ShotEquations, z: Array, scale: Array) -> Record:
    """{kind, side}: pitchfork or transcritical, nonsmooth where the orbit has corners, and where the new orbits lie."""
    plane = family_tangents(problem, z, scale)
    if len(plane) < 2:
        return {}
    own = np.asarray(plane[0])
    moved = []
    for sense in (1, -1):
        found = crossing(problem, z, own, scale, sense)
        if found is not None:
            moved.append((float(found.orbit[-1] - z[-1]), found.orbit))
    if not moved:
        return {}
    nonsmooth = any(f.crossed for f in flights(problem, z, np.empty(0)))
    form: Fields = {"kind": "nonsmooth"} if nonsmooth else {}
    signs = {np.sign(m) for m, _ in moved}
    if len(moved) == 2 and len(signs) == 2 and not image_of(problem, moved[0][1], moved[1][1]):
        form.setdefault("kind", "transcritical")
        return form
    form.setdefault("kind", "pitchfork")
    form["side"] = "above" if moved[0][0] > 0.0 else "below"
    return form


def image_of(problem: ShotEquations, a: Array, b: Array) -> str | None:
    """The declared symmetry that maps one orbit (as a set) onto the other."""
    times = np.linspace(0.0, 1.0, 65)[:-1]
    u, v = states(problem, a, times), states(problem, b, times)
    sizes = np.maximum(np.ptp(u, axis=0), np.abs(u).max(axis=0))
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    apart = float(np.abs((u - v) / sizes).max())
    p = problem.full_parameters(a)
    for symmetry in problem.system.model.symmetries:
        image = problem.system.symmetry(symmetry.name, np.ascontiguousarray(u), p)
        for shift in (0, 32):
            if float(np.abs((np.roll(image, shift, axis=0) - v) / sizes).max()) < 0.1 * apart + ROUNDED:
                return str(symmetry.name)
    return None
