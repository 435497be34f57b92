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

Solve = Callable[[System, Array], Array]  # an equilibrium of a system from a guess; NoSolutionError where there is none


@dataclass(frozen=True, eq=False)
class Pseudo:
    """A surface, the system that slides on it, and the pseudo-equilibrium."""

    jump: Jump
    system: Any
    u: Array


def is_on(jump: Jump, u: Array, p: Array) -> bool:
    """True for states on the surface, where the equations jump: their value there is neither side's."""
    h, slope = jump.height(u, p)
    return bool(abs(h) <= ON * float(np.abs(slope) @ np.abs(np.concatenate([u, p])))) and jump.is_jump(u, p)


def surface_at(system: System, u: Array, p: Array) -> Jump | None:
    """The first surface that u lies on, of those that the equations of a flow jump at."""
    if system.kind != "flow":
        return None
    return next((jump for jump in jumps_of(system) if is_on(jump, u, p)), None)


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
            found = solve(slid, at)
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
