"""From a start next to a surface that motion slides on to the pseudo-equilibrium there (Filippov 1988, section 19).

f_s = (1 - a) f- + a f+,   grad h . f_s = 0,   0 < a < 1;   f_s = 0 and h = 0 at the pseudo-equilibrium
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError, NotFiniteError
from contin.lowering import compile_system
from contin.lowering.sliding import sliding_model
from contin.problems.surfaces.jumps import Jump, jumps_of
from contin.systems.protocol import System

FASTER: Final = 4.0  # the normal rate beside the largest eigenvalue of either field
DIGITS: Final = 3  # of the normal rate
ON: Final = 1e-9  # |h|, relative to its terms, on the surface
LOST: Final = 16.0  # roundings of the terms of f, by which an equilibrium may be off

Solve = Callable[[System, Array], Array]  # an equilibrium of a system from a guess; NoSolutionError where there is none


@dataclass(frozen=True, eq=False)
class Pseudo:
    """A surface, the system that slides on it, and the pseudo-equilibrium."""

    jump: Jump
    system: Any
    u: Array


def is_on(jump: Jump, u: Array, p: Array, spread: Array | None = None) -> bool:
    """True for states on the surface, where the equations jump: their value there is neither side's.

    spread (n,) : by how much rounding may move the states, see `rounding_of`.
    """
    h, slope = jump.height(u, p)
    near = abs(h) <= ON * float(np.abs(slope) @ np.abs(np.concatenate([u, p])))
    if not near and spread is not None:
        near = abs(h) <= float(np.abs(slope[: len(u)]) @ spread)
    return bool(near) and jump.is_jump(u, p)


def rounding_of(system: System, u: Array, p: Array) -> Array:
    """By how much an equilibrium u may be off: |A^-1| times the rounding errors of the terms of f, (n,).

    A state that is zero has no size of its own: one at 0 comes out of Newton's method as 1e-17 of what it is made of.
    """
    slopes = np.abs(np.asarray(system.jacobian(u, p)[1]))[:, : len(u) + len(p)]
    terms = slopes @ np.abs(np.concatenate([u, p]))
    try:
        inverse = np.linalg.inv(np.asarray(system.jacobian(u, p)[1])[:, : len(u)])
    except np.linalg.LinAlgError:
        return np.zeros(len(u))
    spread = LOST * np.finfo(float).eps * (np.abs(inverse) @ terms)
    return np.where(np.isfinite(spread), spread, 0.0)


def surface_at(system: System, u: Array, p: Array, solved: bool = False) -> Jump | None:
    """The first surface that u lies on, of those that the equations of a flow jump at; `solved`: an equilibrium u."""
    if system.kind != "flow":
        return None
    jumps = jumps_of(system)
    spread = rounding_of(system, u, p) if solved and jumps else None
    return next((jump for jump in jumps if is_on(jump, u, p, spread)), None)


@dataclass(frozen=True, eq=False)
class Boundary:
    """An equilibrium of one side of a surface that lies on it, and its place as far inside that side as it is known."""

    jump: Jump
    upper: bool
    u: Array

    @property
    def text(self) -> str:
        """Such as 'x > 0'."""
        return f"{self.jump.surface.text[:-4]} {'>' if self.upper else '<'} 0"


def boundary_equilibrium(system: System, u: Array, p: Array, solve: Solve) -> Boundary | None:
    """The equilibrium of one side on a surface through u; None where no surface passes, or where there is none.

    Its states are moved into that side by their rounding errors, for the equations have that side's value there.
    """
    if system.kind != "flow":
        return None
    for jump in jumps_of(system):
        at = jump.nearest(u, p)
        if not is_on(jump, at, p):
            continue
        for upper in (False, True):
            side = jump.held(upper, at, p)
            try:
                found = solve(side, at)
            except (NoSolutionError, NotFiniteError):  # none on this side: the other one
                continue
            spread = rounding_of(side, found, p)
            if not is_on(jump, found, p, spread):
                continue
            inside = _moved(jump, found, p, spread, upper)
            if (jump.height(inside, p)[0] > 0.0) == upper:
                return Boundary(jump, upper, inside)
    return None


def _moved(jump: Jump, u: Array, p: Array, spread: Array, upper: bool) -> Array:
    """States off the surface by what rounding may move them."""
    h, slope = jump.height(u, p)
    normal = slope[: len(u)]
    least = np.finfo(float).eps * np.abs(u)
    aside = max(float(np.abs(normal) @ np.maximum(spread, least)), np.finfo(float).tiny)
    return u + ((aside if upper else -aside) - h) * normal / float(normal @ normal)


def pseudo_equilibrium(system: System, u: Array, p: Array, solve: Solve) -> Pseudo | None:
    """The first pseudo-equilibrium found from u on a surface that motion slides on there; None where none is."""
    if system.kind != "flow":
        return None
    for jump in jumps_of(system):
        at = jump.nearest(u, p)
        rate = _normal_rate(jump, at, p)
        if rate is None or not jump.is_jump(at, p):
            continue
        slid = compile_system(sliding_model(jump.model, jump.surface, rate), regular=True)
        try:
            found = jump.nearest(solve(slid, at), p)  # where both fields cancel, the states are on it to rounding alone
        except (NoSolutionError, NotFiniteError):  # no rest in sliding on this surface: the next one
            continue
        weight = float(np.asarray(slid.observables(found[None], p[None]))[0, -1])
        if 0.0 < weight < 1.0 and _normal_rate(jump, found, p) is not None and is_on(jump, found, p):
            return Pseudo(jump, slid, found)
    return None


def _normal_rate(jump: Jump, u: Array, p: Array) -> float | None:
    """How fast the sliding system returns to its surface; None where the fields do not both lead to it."""
    n = len(u)
    below, above = jump.lower.value(u, p), jump.upper.value(u, p)
    normal = jump.height(u, p)[1][:n]
    up, down = float(normal @ below), float(normal @ above)
    if not up > 0.0 > down:
        return None
    matrices = [np.asarray(side.jacobian(u, p)[1])[:, :n] for side in (jump.lower, jump.upper)]
    if not all(np.isfinite(matrix).all() for matrix in matrices):
        return None
    largest = max(float(np.abs(np.linalg.eigvals(matrix)).max()) for matrix in matrices) or up - down
    return float(f"{FASTER * largest / (up - down):.{DIGITS}g}")
