"""How far the equations of a model hold, where it is an approximation (an averaged one)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.model.model import Model

if TYPE_CHECKING:
    from contin.systems.protocol import System

POLE: Final = (
    "the algebraic equations ({}) no longer determine the algebraic states: an eigenvalue passes through infinity and "
    "the index rises above 1 (a singularity-induced bifurcation). Start anew beyond it"
)


def left_reach(system: System, states: Array, parameters: Array) -> tuple[int, str] | None:
    """The first of N points at which the model's equations do not hold, and why; None where they hold at all.

    With algebraic states: the first that lies beyond a singularity of their equations, seen from the first point.

    system : compiled.  states : (N, n), parameters : (N, p_size).
    """
    if not len(states):
        return None
    states, parameters = np.ascontiguousarray(states), np.ascontiguousarray(parameters)
    left = _singular(system, states, parameters)
    if not system.limits:
        return left
    margins = system.margins(states, parameters)
    broken = ~(margins >= 0.0)
    rows = np.flatnonzero(broken.any(axis=1))
    if not rows.size or (left is not None and left[0] <= rows[0]):
        return left
    row = int(rows[0])
    return row, str(system.limits[int(np.argmax(broken[row]))].beyond)


def first_to_leave(
    system: System, count: int, orbit: Callable[[int], tuple[Array, Array]]
) -> tuple[int, str] | None:
    """The first of several orbits on which the model's equations do not hold somewhere, and why.

    orbit : (states (N, n), parameters (N, p_size)) of each.
    """
    if not has_reach(system):
        return None
    before: tuple[Array, Array] | None = None
    for row in range(count):
        states, parameters = orbit(row)
        before = before or (states[:1], parameters[:1])
        left = left_reach(system, np.vstack([before[0], states]), np.vstack([before[1], parameters]))
        if left is not None:
            return row, left[1]
    return None


def has_reach(system: System) -> bool:
    """True where `left_reach` may find points at which the equations do not hold."""
    return bool(system.limits) or is_constrained(system)


def is_constrained(system: System) -> bool:
    """True for flows with algebraic states."""
    model = getattr(system, "model", None)
    return isinstance(model, Model) and model.constraints is not None


def _singular(system: System, states: Array, parameters: Array) -> tuple[int, str] | None:
    """The first point at which the index has risen above 1 since the first one."""
    model = getattr(system, "model", None)
    if not isinstance(model, Model) or model.constraints is None:
        return None
    values = system.index_determinants(states, parameters)  # type: ignore[attr-defined]
    rows = np.flatnonzero(~(values * np.sign(values[0]) > 0.0))
    return (int(rows[0]), POLE.format(", ".join(model.constraints.equations))) if rows.size else None
