"""Solutions of a boundary-value problem at a fixed parameter, by Newton's method: damped, or with whole steps.

Most are asked next to a known solution. There the factors of one matrix serve as long as each step is a small part of
the one before, and the end is where a step is nothing, or the residual is rounding of its own terms.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.bvp.condensed import Condensed, linearise, met_to_rounding, residual_at
from contin.linalg.newton import Rules, longest_part, newton
from contin.linalg.vectors import norm

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

NEWTON: Final = 20  # iterations
SHORTEST: Final = 1e-3  # damping
WHOLE: Final = Rules(settled=1e-3, stalled=0.0, far=1e4, budget=60)  # steps, until the damped iteration takes over
ACCURATE: Final = 1e-13
STALLED: Final = 1e-8  # a correction that no longer falls, because of rounding
BLURRED: Final = 1e-4  # a correction that may be rounding of a nearly singular problem
FALLEN: Final = 0.01  # part of the residual that is left after a Newton step that has worked
NEARBY: Final = 1e-2  # a first step from a guess next to the solution: from farther away quadratic convergence counts
FAST: Final = 0.01  # part of a step before up to which factors serve again: new ones cost four times as much


def at_parameter(problem: BoundaryEquations, guess: Array, value: float, scale: Array) -> Array | None:
    """Damped Newton's method with the parameter fixed; None where it fails."""
    fixed = np.zeros_like(scale)
    fixed[-1] = 1.0
    z = guess.copy()
    z[-1] = value
    before, damping, near = np.inf, 1.0, False
    for iteration in range(NEWTON):
        here = linearise(problem, z, fixed, scale)
        if here is None or here.sign == 0.0:
            return None
        step = here.solve(np.append(-here.residual, 0.0))
        size = norm(step)
        if not np.isfinite(size):
            return None
        near = size < NEARBY if iteration == 0 else near
        if size < ACCURATE or (size >= 0.5 * before and size < STALLED):
            return z if size >= before else _moved(z, scale, step, value)
        if 0.1 * before < size < BLURRED and met_to_rounding(here, here.residual, z):  # (shrinking steps are no noise)
            return z
        ahead = partial(_ahead, problem, here, z, scale, step, value)
        found = longest_part(ahead, size, STALLED, min(1.0, 4.0 * damping), SHORTEST)
        if found is None:
            return z if size < BLURRED and met_to_rounding(here, here.residual, z) else None
        damping, (z, left, residual) = found
        if damping == 1.0 and norm(left) < ACCURATE:
            return _moved(z, scale, left, value)
        before = size if damping == 1.0 else np.inf
        if damping == 1.0 and near:
            z, before, solved = _by_chords(problem, here, z, scale, left, residual, size, value)
            if solved:
                return z
    return None


def _by_chords(
    problem: BoundaryEquations, here: Condensed, z: Array, scale: Array, left: Array, residual: Array, size: float,
    value: float,
) -> tuple[Array, float, bool]:  # fmt: skip
    """Where further steps by the same factors lead while they fall fast, the last one's length; and is it a solution?

    left : the first of them, from z with its residual, to which a step of this size has led. A step that does not fall
    is no sign of a solution, as where F_u is nearly singular; a residual that is rounding is.
    """
    further = norm(left)
    while further < FAST * size:
        there = _moved(z, scale, left, value)
        at_it = residual_at(problem, there)
        if at_it is None:
            break
        residual = at_it
        z, size, left = there, further, here.solve(np.append(-residual, 0.0))
        further = norm(left)
        if further < ACCURATE:
            return _moved(z, scale, left, value), further, True
    return z, size, further < BLURRED and met_to_rounding(here, residual, z)


def at_parameter_from_afar(problem: BoundaryEquations, guess: Array, value: float, scale: Array) -> Array | None:
    """Newton with the parameter fixed and whole steps, as far as they lead; None: no solution by the rules `WHOLE`.

    Where damping keeps a guess between two solutions, whole steps leave that place. (Guesses of localised patterns of
    the Swift-Hohenberg equation: 13 of 16 find a solution, 4 with damping.)
    """
    fixed = np.zeros_like(scale)
    fixed[-1] = 1.0
    z = guess.copy()
    z[-1] = value

    def correct(z: Array) -> tuple[float, Array] | None:
        here = linearise(problem, z, fixed, scale)
        if here is None or here.sign == 0.0:
            return None
        step = here.solve(np.append(-here.residual, 0.0))
        return norm(step), _moved(z, scale, step, value)

    found = newton(correct, z, WHOLE)
    return None if found is None else at_parameter(problem, found.at, value, scale)


def _ahead(
    problem: BoundaryEquations, here: Condensed, z: Array, scale: Array, step: Array, value: float, part: float
) -> tuple[float, tuple[Array, Array, Array]] | None:
    """The length of the next step after a part of this one; the place, that step by the same factors, and the residual
    there. The length is 0 where a step has worked although the next one is no shorter: F_u is nearly singular there."""
    there = _moved(z, scale, part * step, value)
    left = residual_at(problem, there)
    if left is None:
        return None
    further = here.solve(np.append(-left, 0.0))
    again = norm(further)
    works = again < BLURRED and norm(left) < FALLEN * norm(here.residual)
    return 0.0 if works else again, (there, further, left)


def _moved(z: Array, scale: Array, step: Array, value: float) -> Array:
    moved = z + scale * step
    moved[-1] = value
    return moved
