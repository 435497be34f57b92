"""Where two families of orbits found by shooting cross: interpolated between orbits of one of them beside the point.

Next to the point itself Newton's method leaves the direction of the crossing family undetermined, so that nothing
measured there is accurate.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Failure, Rejected
from contin.problems.orbits.linearised.multipliers import nontrivial
from contin.problems.shooting.layout import moving
from contin.problems.shooting.linear import embedded, family_tangents, null_space
from contin.problems.shooting.locate import Located, locate, on_curve, scalar, scale_of
from contin.problems.tolerances import SETTLED

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

APART = (1e-2, 2.5e-3, 6e-4, 1.5e-4)  # arclengths between the orbits that a branch point is interpolated from
AGREED = 1e-8  # (arclength) places interpolated from two of them that agree so well are final
CONVERGED = 1e-6  # (arclength) Newton steps below this, ...
PATIENCE = 3  # ... of which so many in succession improved nothing, are rounding
NEWTON = 30


def locate_branch_point(
    problem: ShotEquations, type_: str, z: Array, tangent: Array, scale: Array
) -> Located | Rejected:
    """As `_interpolated`, from orbits as far away as they exist, then nearer ones until the place stays the same.

    The further away, the less rounding matters; but another branch point may lie between.
    """
    found: Located | Rejected = Rejected("an orbit beside it is lost")
    if problem.fixed is not None:  # the family itself is regular where only a symmetry breaks
        found = locate(problem, type_, z, tangent, scale)
        if isinstance(found, Located) and len(family_tangents(problem, found.z, scale)) > 1:
            return found
    best: Located | None = None
    for apart in APART:
        found = _interpolated(problem, type_, z, tangent, scale, apart)  # from z again: of several zeros, its own
        if isinstance(found, Rejected):
            if best is not None:
                break
            continue
        if best is None:
            best = replace(found, error=apart)
            continue
        moved = float(np.linalg.norm(np.where(scale > 0.0, (found.z - best.z) / scale, 0.0)))
        if moved < AGREED:
            return replace(best, error=moved)
        if moved >= best.error:
            break  # rounding
        best = replace(found, error=moved)
    return found if best is None else best


def _interpolated(
    problem: ShotEquations, type_: str, z: Array, tangent: Array, scale: Array, apart: float
) -> Located | Rejected:
    """The branch point on the family through z, by interpolation between orbits at a distance from it.

    The orbits at +-d and +-2 d along the family are accurate; polynomials through them give the arclength at which the
    multiplier is 1, and the orbit there, with an error of the fourth order in d.
    """
    t = _direction(problem, z, tangent, scale, apart)
    if t is None:
        return Rejected("the family cannot be followed through it")
    base = z
    for distance in (apart, apart):
        lengths, orbits, values = [], [], []
        for s in distance * np.array([-2.0, -1.0, 1.0, 2.0]):
            orbit = _beside(problem, base, t, s, scale)
            if isinstance(orbit, Failure):
                return Rejected(f"an orbit beside it is lost ({orbit.value})")
            lengths.append(s)
            orbits.append(orbit)
            values.append(scalar(type_, nontrivial(problem, problem.multipliers(orbit)), t))
        roots = np.roots(np.polyfit(lengths, values, 3))
        real = roots.real[np.abs(roots.imag) < 1e-9 * distance]
        if not real.size or float(np.abs(real).min()) > 3.0 * distance:
            return Rejected("the multiplier does not pass 1 nearby")
        step = float(real[np.argmin(np.abs(real))])
        weights = [np.prod([(step - b) / (a - b) for b in lengths if b != a]) for a in lengths]
        base = np.array(weights) @ np.array(orbits)
    refined = on_curve(problem, type_, base, t, scale)
    return Rejected("the orbit is lost") if refined is None else Located(refined[0], refined[2])


def _beside(problem: ShotEquations, base: Array, t: Array, s: float, scale: Array) -> Array | Failure:
    """The orbit at arclength s from base along t, by Newton until rounding: near the point that is not very small.

    On a piecewise linear map (two oscillators that cross a surface together, in either order) Newton's steps may shrink
    slowly at first, so the best of the iterates is taken once none was better for some time.
    """
    y, size, best, least, since = s * t, np.inf, None, np.inf, 0
    for _ in range(NEWTON):
        z = base + scale_of(y, scale)
        here = problem.linearisation(z, t, scale)
        if here is None:
            return Failure.NOT_FINITE
        if here.sign == 0.0:
            return Failure.SINGULAR
        miss = float(np.linalg.norm(np.append(here.residual, s - float(t @ y))))
        since = 0 if miss < 0.5 * least else since + 1
        if miss < least:
            best, least = z, miss
        if size < SETTLED or (size < CONVERGED and since >= PATIENCE):
            return best if best is not None else Failure.NOT_FINITE
        step = here.solve(np.append(-here.residual, s - float(t @ y)))
        size = float(np.linalg.norm(step))
        if not size < 0.1:
            return Failure.DIVERGED
        y = y + step
    return Failure.NO_CONVERGENCE


def _direction(problem: ShotEquations, z: Array, tangent: Array, scale: Array, apart: float) -> Array | None:
    """A tangent of a family through the branch point near z: `tangent`, or the direction that changes p the most."""
    plane = null_space(problem, z, scale)
    if plane is None:
        return None
    rates = plane[2][-2:, -1]
    steepest = embedded(rates @ plane[2][-2:], moving(len(z), problem.n), len(z))
    for guess in (tangent, steepest):
        size = float(np.linalg.norm(guess))
        if size == 0.0:
            continue
        t = guess / size
        found = (_beside(problem, z, t, s, scale) for s in (apart, -apart))
        sides = [side for side in found if not isinstance(side, Failure)]
        if len(sides) < 2:
            continue
        ahead, behind = (np.where(t == 0.0, 0.0, (side - z) / scale) for side in sides)
        chord = ahead - behind
        length = float(np.linalg.norm(chord))
        if length > 1.9 * float(np.linalg.norm(ahead)) and length > 1.9 * float(np.linalg.norm(behind)):
            return np.asarray(chord / length)
    return None
