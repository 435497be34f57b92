"""Consistent initial values of flows with algebraic states (`symbolic.passes.index_one`)."""

from __future__ import annotations

from functools import partial
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.linalg.newton import longest_part
from contin.lowering.system import CompiledSystem

ITERATIONS: Final = 50
SHORTEST: Final = 2.0**-20  # damping
EXACT: Final = 1e-14  # relative step with which Newton's method ends
CLOSE: Final = 1e-9  # where rounding keeps it from that
MOVED: Final = 1e-9  # relative change of a state that is worth a word


def consistent(system: CompiledSystem, u: Array, p: Array) -> Array:
    """The state near u at which the algebraic equations hold, by damped Newton steps in the states without mass.

    p : (p_size,).  Raises NoSolutionError.
    """
    if system.constraints is None:
        return u
    here, before, g = u, np.inf, np.abs(system.algebraic(u, p))
    weights = 1.0 / np.where(g > 0.0, g, g.max(initial=0.0) or 1.0)
    for _ in range(ITERATIONS):
        step, left = system.correction(here, p), _length(system, here, p, weights)
        size, largest = float(np.abs(step).max()), float(np.abs(here).max())
        if not np.isfinite(size):
            break
        if size <= EXACT * largest or (size >= 0.5 * before and before <= CLOSE * largest):
            return np.asarray(here - step)
        ahead = partial(_after, system, p, weights, here, step)
        found = longest_part(ahead, left, 0.0, shortest=SHORTEST)
        if found is None and size > CLOSE * largest:
            break
        here, before = here - step if found is None else found[1], size
    names = ", ".join(system.constraints.equations)
    raise NoSolutionError(
        f"no consistent values of the algebraic states near this start: the equations of {names} were not solved by "
        "Newton's method (perhaps the index is above 1 there). Give a start nearer to a solution of them"
    )


def _length(system: CompiledSystem, u: Array, p: Array, weights: Array) -> float:
    """How far the algebraic equations are from being solved, each relative to the start; NaN without a value."""
    return float(np.linalg.norm(weights * system.algebraic(u, p)))


def _after(
    system: CompiledSystem, p: Array, weights: Array, u: Array, step: Array, part: float
) -> tuple[float, Array]:
    there = u - part * step
    return _length(system, there, p, weights), there


def consistent_start(system: object, u: Array, p: Array) -> Array:
    """`consistent` at the time 0, of any system: u itself where nothing is algebraic."""
    if not isinstance(system, CompiledSystem):
        return u
    return consistent(system, u, np.append(p, 0.0) if system.is_forced else p)


def moved_onto(system: CompiledSystem, given: Array, found: Array) -> str:
    """What consistent initial values changed, in words; empty where nothing (and where states have no names)."""
    if found is given or not system.state_names:
        return ""
    changed = [
        f"{name} = {new:.6g}"
        for name, old, new in zip(system.state_names, given.tolist(), found.tolist(), strict=True)
        if abs(new - old) > MOVED * max(abs(old), abs(new))
    ]
    return f"consistent initial values: {', '.join(changed)}" if changed else ""


def onto_constraints(system: CompiledSystem, states: Array, parameters: Array) -> Array:
    """States (N, n) of a trajectory, near the algebraic equations, on them: one step of Newton's method."""
    if not isinstance(system, CompiledSystem) or system.constraints is None or not len(states):
        return states
    moved = states - system.correction(np.ascontiguousarray(states), np.ascontiguousarray(parameters))
    return np.where(np.isfinite(moved), moved, states)
