"""Where another family crosses: a second multiplier 1.

There the equations are singular: near it Newton's method finds the family only as well as rounding over the distance
lets it. The point is therefore not approached: the multiplier, and the orbit, are interpolated from orbits on both
sides, which planes give that are normal to the tangent at the row that the step set out from.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Outcome, Verified, unverified
from contin.continuation.sample import Frame, Sample
from contin.linalg.vectors import dot, norm
from contin.machine import elementary
from contin.problems.large_orbits.crossing import Place, with_kind
from contin.problems.large_orbits.events import SAFETY, excess
from contin.problems.large_orbits.multipliers import critical_index
from contin.problems.sparse.zero_on_curve import At, point_at

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations

APART: Final = (0.02, 0.01, 0.005)  # scaled distances between the orbits that are interpolated, in turn
PLACES: Final = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
RESIDUAL_LIMIT: Final = 1e-6


def verify(problem: LargeOrbitEquations, near: Sample, frame: Frame) -> Outcome:
    """The branch point of cycles near a sample."""
    base = problem.memory.origin
    if base is None:
        return unverified("BPC", "no orbit apart from it is known")
    problem.settle(base.z, base.tangent, frame.scale)
    line = near.z - base.z
    length = dot(base.tangent, line / frame.scale)
    if length == 0.0:
        return unverified("BPC", "no orbit apart from it is known")
    centre, found = length, None
    for apart in APART:  # every time about a better zero
        found = _samples(problem, base, frame, centre + apart * PLACES, line / length)
        if found is None:
            return unverified("BPC", "the family is not found on both sides")
        centre = _zero(found[0], found[2])
        if not abs(centre - length) < 3.0 * APART[0]:
            return unverified("BPC", "the multiplier does not cross 1 there")
    assert found is not None
    places, points, values = found
    inner = slice(1, 5)
    z = _interpolated(places, np.array([at.z for at in points]), centre)
    rough = _zero(places[inner], values[inner])
    other = _interpolated(places[inner], np.array([at.z for at in points[inner]]), rough)
    tangent = _interpolated(places, np.array([at.tangent for at in points]), centre)
    if min(at.tangent[-1] for at in points) < 0.0 < max(at.tangent[-1] for at in points):
        return NOTHING  # the multiplier of a fold, which has its own label
    residual = norm(problem.residual(z)[:-1] / frame.scale[:-2])
    if not residual < RESIDUAL_LIMIT:
        return unverified("BPC", f"orbits on both sides do not lead there (residual {residual:.1e})")
    multipliers, vectors = problem.multipliers(z, exactly=True)
    k = critical_index(multipliers, "BPC")
    if k is None:
        return unverified("BPC", "the multiplier that crosses is lost")
    others = np.delete(multipliers, k)
    fine = _on_finer_mesh(problem, base, frame, centre, line / length)
    moved = np.inf if fine is None else SAFETY * abs(float(fine.z[-1] - z[-1]))
    error = 2.0 * abs(float(other[-1] - z[-1])) + moved
    point = Verified(
        "BPC", z, max(residual, abs(float(multipliers[k].real) - 1.0)), error,
        np.append(1.0 + 0.0j, multipliers), int(np.sum(np.abs(others) > 1.0)), {},
        {"q": vectors[:, k].real, "own": tangent / norm(tangent)},
    )  # fmt: skip
    return with_kind(point, Place(problem, z, tangent * frame.scale), fine)


def _on_finer_mesh(
    problem: LargeOrbitEquations, base: Sample, frame: Frame, centre: float, line: Array
) -> Place | None:
    """The branch point by the same interpolation on a mesh of half the lengths; None where that fails."""
    fine = problem.on_half_lengths(base.z, base.tangent, frame.scale)
    if fine is None:
        return None
    finer, there, scale = fine
    start = replace(base, z=there.z, tangent=there.tangent)
    _, moved, _ = problem.finer()
    found = _samples(finer, start, Frame(scale), centre + APART[-1] * PLACES, moved(line))
    if found is None:
        return None
    places, points, values = found
    zero = _zero(places, values)
    z = _interpolated(places, np.array([at.z for at in points]), zero)
    tangent = _interpolated(places, np.array([at.tangent for at in points]), zero)
    return Place(finer, z, tangent * scale) if np.all(np.isfinite(z)) else None


def _samples(
    problem: LargeOrbitEquations, base: Sample, frame: Frame, places: Array, line: Array
) -> tuple[Array, list[At], Array] | None:
    """Orbits at these distances from the base, and the logarithm of their multiplier."""
    points: list[At] = []
    values = []
    for s in places.tolist():
        guess = base.z + s * line
        if len(points) == 1:
            guess = points[0].z + (s - places[0]) * line
        elif points:
            guess = _interpolated(places[: len(points)], np.array([at.z for at in points]), s)
        at = point_at(problem, base, s, guess, frame)
        if at is None:
            return None
        points.append(at)
        values.append(float(elementary.log1p(excess(problem, at, "BPC"))))
    return places, points, np.array(values)


def _interpolated(x: Array, y: Array, at: float) -> Array:
    """The polynomial through (x, y) at a place."""
    weights = [float(np.prod((at - np.delete(x, k)) / (x[k] - np.delete(x, k)))) for k in range(len(x))]
    return np.asarray(np.einsum("k,k...->...", np.array(weights), y))


def _zero(x: Array, y: Array) -> float:
    """Where y vanishes, by inverse interpolation; NaN where it takes a value twice."""
    if len(np.unique(y)) < len(y):
        return float("nan")
    return float(_interpolated(y, x, 0.0))


def null_vector(problem: LargeOrbitEquations, z: Array, q: Array, own: Array, scale: Array) -> Array:
    """The null vector of the orbit's equations, without dp, that the multiplier's vector q belongs to.

    In scaled unknowns, of length 1, normal to the family's own tangent.

    M q = q + c f(u(0)): the period changes by -c, and the phase is that of z.
    """
    sweeps, orbit, p = problem.sweeps(z), problem.profile(z), problem.full_parameters(z)
    assert sweeps is not None
    velocity = problem.velocity(z)
    moved = sweeps.monodromy(q)
    c = dot(velocity, moved - q) / dot(velocity, velocity)
    d = sweeps.along(q, -c * problem.by_scalars(z, ())[0])
    states = problem.layout.pick(d, q, None)
    slopes = problem.layout.slopes(problem.points, p, orbit)
    weighted = slopes * problem.layout.weights(orbit)
    states = states - slopes * (float(np.sum(weighted * states)) / float(np.sum(weighted * slopes)))
    vector = np.concatenate([states, [-c, 0.0]]) / scale
    vector -= dot(vector, own) * own
    return np.asarray(vector / norm(vector))
