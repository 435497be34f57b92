"""From a trajectory that misses the second saddle to one that comes to it: the homotopy by which connections are found.

The trajectory leaves the first saddle in its unstable eigenspace and ends somewhere near the second one, where its part
in the unstable directions of that saddle is w. Steps (after Champneys, Kuznetsov and Sandstede 1996, and Doedel,
Friedman and Monteiro 1994, who bring the components of w to zero one by one):

1.  L_u(x1)^T (u(1) - x1) = t w is followed from t = 1 to t = 0 by pseudo-arclength, with the first parameter free, or,
    where connections persist, the direction in which the orbit leaves: the end now lies in the stable eigenspace.
2.  The interval of time is made longer, and the end comes along the stable manifold towards the saddle.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.corrector import correct
from contin.continuation.outcome import Failure
from contin.errors import InputError, NoSolutionError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.interval import Reach, distances, fitted
from contin.homoclinic.projections import arriving_parts
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import UNBOUNDED

if TYPE_CHECKING:
    from contin.continuation.corrector import Corrected

NEAR: Final = 0.02  # distance of the ends, relative to the orbit's extent, that Newton's method needs no homotopy for
STEPS: Final = 60
FAR: Final = 10.0  # sizes of the parameter, or of the distance that is to vanish, at which the homotopy is lost
FIRST, LARGEST, SMALLEST = 0.05, 0.3, 1e-4  # arclength
TOLERANCE: Final = 1e-7  # of Newton's steps on the way
EASY: Final = 4  # of its iterations, after which steps grow
SHORTER: Final = 0.3  # factor by which the end comes nearer in one lengthening
LENGTHENINGS: Final = 8


class StepFailed(NoSolutionError):
    """A step of the homotopy leads nowhere; which one, in words."""


def brought_home(curve: ConnectionCurve, arc: Profile, ends: Array, q: float) -> tuple[Profile, Array]:
    """The orbit whose end is near the second saddle, and the saddles, at the value of p that this needs.

    Raises StepFailed, with the step of the homotopy.
    """
    sizes = curve.orbits.state_sizes(arc)
    arc = arc.on_mesh(choose_mesh(arc, sizes, curve.orbits.tolerance, curve.orbits.intervals).h)
    z = curve.join(arc, ends, q)
    if curve.reversor is None and max(distances(curve, z, sizes)) <= NEAR:
        return arc, ends
    if curve.unstable_count:
        z = _in_the_stable_eigenspace(curve, z, sizes)
    z = _lengthened(curve, z, sizes)
    return curve.profile(z), curve.equilibria(z)


def _in_the_stable_eigenspace(curve: ConnectionCurve, z: Array, sizes: Array) -> Array:
    """Step 1; the result has q in its place again."""
    persists = len(curve.slots) == 1
    missed = arriving_parts(curve.settled(z, sizes), z, sizes)
    base = curve.orbits.base.copy()
    if not persists:
        base[curve.second] = z[-2]
    own, slots = replace(curve.orbits, base=base), (-2,) if persists else (-2, -1)
    moving = replace(curve, orbits=own, aim=missed, slots=slots, gauge=None)
    q, z = float(z[-2]), z.copy()
    z[-2] = 1.0
    problem = ConnectionProblem(moving)
    first, _ = problem.widths(z, UNBOUNDED)
    scale = problem.scale_for(curve.profile(z).h, sizes, first, 1.0)
    name = moving.system.parameter_names[moving.first]
    try:
        tangent = np.asarray(problem.tangents(z, scale)[0])
    except InputError as error:
        raise StepFailed(f"step 1 of the homotopy cannot begin: {error}") from None
    tangent = -tangent if tangent[-2] > 0.0 else tangent
    problem = problem.settled(z, scale)
    length, began = FIRST, float(z[-1])
    for _ in range(STEPS):
        found = correct(problem, z, tangent, length, length * tangent, scale, TOLERANCE)
        if isinstance(found, Failure):
            length *= 0.5
            if length < SMALLEST:
                break
            continue
        if found.z[-2] <= 0.0:
            at = _at_zero(problem, z, found.z, scale)
            if at is not None:
                at[-2] = q
                return at
            length *= 0.5
            continue
        tangent, z = _tangent(found), found.z
        if z[-2] > FAR or abs(z[-1] - began) > FAR * first:
            break
        problem = problem.settled(z, scale)
        length = min(LARGEST, 1.5 * length) if found.iterations <= EASY else length
    raise StepFailed(
        f"step 1 of the homotopy (bringing the trajectory's end into the "
        f"{'stable eigenspace of the saddle' if curve.reversor is None else 'fixed space of the reversor'}, with "
        f"{'the direction in which it leaves' if persists else name} free) stops where {max(z[-2], 0.0):.2g} of the "
        f"distance is left, at {name} = {z[-1]:.8g}"
    )


def _at_zero(problem: ConnectionProblem, before: Array, after: Array, scale: Array) -> Array | None:
    """The point with t = 0 between two others."""
    part = before[-2] / (before[-2] - after[-2])
    return problem.at_unknown(-2, before + part * (after - before), 0.0, scale)


def _tangent(found: Corrected) -> Array:
    """In the sense of the last one, which is a row of the equations."""
    t = found.last.solve(np.append(np.zeros(found.z.size - 1), 1.0))
    return np.asarray(t / np.linalg.norm(t))


def _lengthened(curve: ConnectionCurve, z: Array, sizes: Array) -> Array:
    """Step 2: both ends within `NEAR` of the saddles."""
    problem = ConnectionProblem(curve)
    for _ in range(LENGTHENINGS):
        apart = max(distances(curve, z, sizes))
        if apart <= NEAR:
            return z
        longer = fitted(curve, z, sizes, Reach(SHORTER * apart, SHORTER * apart, 0.0))
        profile = curve.profile(longer)
        h = choose_mesh(profile, sizes, curve.orbits.tolerance, curve.orbits.intervals).h
        longer = curve.join(profile.on_mesh(h), curve.equilibria(longer), float(longer[-2]))
        scale = problem.initial_scale(longer, UNBOUNDED)
        solved = problem.at_held(longer, scale)
        if solved is None:
            break
        z = solved
    else:
        if max(distances(curve, z, sizes)) <= NEAR:
            return z
    raise StepFailed(
        f"step 2 of the homotopy (a longer interval of time, so that the end comes nearer to the saddle) stops at "
        f"{max(distances(curve, z, sizes)):.2g} of the orbit's extent from it, at {problem.place(z)}"
    )
