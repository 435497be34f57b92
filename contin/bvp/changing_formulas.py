"""Places where the equations of a boundary-value problem change formula, such as discontinuous coefficients.

Where a formula changes at a given place (`4 if x > 0.3 else 1`), that place is a node of every mesh: collocation is of
its usual order on both sides, and two meshes tell the error. Across a jump inside an interval it is of first order, and
what two meshes tell is luck. Where the place moves with the solution or the varying parameter no mesh has it as a node
along a branch, and derivatives miss what its motion does: if the equations jump there, that is a note, and no label.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.model.expression import substitute, symbol, symbols_in
from contin.model.parts import TIME
from contin.model.printing import to_text
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

PLACES: Final = 2001  # at which formulas of the independent variable are looked at
HALVINGS: Final = 60  # of a bracket: to rounding
A_NODE: Final = 1e-12  # distance in [0, 1] within which a place is a node
BESIDE: Final = 1e-9  # distance in [0, 1] of values on both sides of a place
JUMP: Final = 1e-6  # of the functions' sizes, over the whole interval: more than smooth changes between them
ROWS: Final = 4  # of a branch that are looked at


@dataclass(frozen=True)
class Jump:
    """The equations jump by `size` (of the functions' sizes) at s = `place`, where `formula` vanishes."""

    place: float
    size: float
    formula: str


def places(problem: BoundaryEquations, profile: Profile) -> Array:
    """s in (0, 1), ascending, where a formula changes that depends on nothing that varies along a branch."""
    known = _still(problem)
    which = [k for k, names in enumerate(_names(problem)) if names <= known and TIME in names]
    if not which:
        return np.empty(0)
    times = np.linspace(0.0, 1.0, PLACES)
    found = [0.5 * (low + high) for k in which for low, high in _changes(problem, profile, k, times)]
    return np.unique([s for s in found if A_NODE < s < 1.0 - A_NODE])


def laid(h: Array, at: Array, fixed: bool) -> Array:
    """The mesh h with the places among its nodes; fixed : of as many intervals.

    The nearer end of the interval that a place is in moves there; where it must stay, the interval is divided.
    """
    nodes, kept = np.concatenate([[0.0], np.cumsum(h)]), {0, len(h)}
    moved = False
    for s in at:
        near = int(np.argmin(np.abs(nodes - s)))
        if abs(nodes[near] - s) > A_NODE:
            moved = True
            free = [k for k in range(len(nodes)) if k not in kept]
            if near in kept and not fixed:
                near = int(np.searchsorted(nodes, s))
                nodes = np.insert(nodes, near, s)
                kept = {k + (k >= near) for k in kept}
            elif near in kept:
                between = [k for k in free if not any(min(nodes[k], s) < nodes[j] < max(nodes[k], s) for j in kept)]
                if not between:
                    continue
                near = min(between, key=lambda k: abs(float(nodes[k]) - s))
            nodes[near] = s
        kept.add(near)
    return np.diff(np.sort(nodes)) if moved else h


def moving_jump(problem: BoundaryEquations, profile: Profile, sizes: Array) -> Jump | None:
    """The largest jump of the equations at a place that moves along a branch; None where there is none."""
    still = _still(problem)
    worst: Jump | None = None
    for k, names in enumerate(_names(problem)):
        if names <= still:
            continue
        times = np.unique(np.concatenate([profile.times, profile.gauss_times]))
        for low, high in _changes(problem, profile, k, times):
            sides = _values(problem, profile, np.clip([low - BESIDE, high + BESIDE], 0.0, 1.0))
            size = float(np.max(np.abs(sides[1] - sides[0]) / sizes))
            if size > JUMP and (worst is None or size > worst.size):
                worst = Jump(0.5 * (low + high), size, _written(problem, k))
    return worst


def remark(problem: BoundaryEquations, z: Array, sizes: Array) -> str:
    """That the equations jump at places that move along the rows z; empty where they do not."""
    for row in np.unique(np.linspace(0, len(z) - 1, ROWS).astype(int)):
        profile = problem.profile(z[row])
        jump = moving_jump(problem, profile, sizes)
        if jump is not None:
            long = float(profile.h[np.searchsorted(profile.mesh[1:-1], jump.place)])
            return (
                f"the equations jump where {jump.formula} = 0, a place that moves along the branch "
                f"(near {problem.parameters[0]} = {profile.parameter:.6g}): values are known to about "
                f"{long * jump.size:.0e} of their size, and folds and branch points are not told. Give each piece "
                "states and an interval of its own, joined by conditions"
            )
    return ""


def _written(problem: BoundaryEquations, k: int) -> str:
    """Switching function k in the model's own independent variable."""
    interval = problem.two.model.interval
    assert interval is not None
    own = (symbol(interval.name) - interval.start) / problem.two.length
    return to_text(substitute([problem.two.system.switching[k]], {symbol(TIME): own})[0])


def _still(problem: BoundaryEquations) -> set[str]:
    """The independent variable and the parameters that are fixed along a branch."""
    return {TIME, *problem.two.parameters} - set(problem.parameters)


def _names(problem: BoundaryEquations) -> list[set[str]]:
    return [set(symbols_in([function])) for function in problem.two.system.switching]


def _changes(problem: BoundaryEquations, profile: Profile, k: int, times: Array) -> list[tuple[float, float]]:
    """Brackets of rounding's width about the changes of sign of switching function k between the times."""
    values = _switch(problem, profile, k, times)
    zero = times[1:-1][values[1:-1] == 0.0]
    low, high = times[:-1], times[1:]
    change = values[:-1] * values[1:] < 0.0
    low, high, before = low[change], high[change], values[:-1][change]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = _switch(problem, profile, k, middle) * before > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return [*zip(low.tolist(), high.tolist(), strict=True), *((s, s) for s in zero.tolist())]


def _switch(problem: BoundaryEquations, profile: Profile, k: int, times: Array) -> Array:
    return np.asarray(problem.two.system.switches(profile.at(times), _parameters(problem, profile, times)))[:, k]


def _values(problem: BoundaryEquations, profile: Profile, times: Array) -> NDArray[np.float64]:
    p = _parameters(problem, profile, times)
    return np.asarray(problem.two.system.jacobians(profile.at(times), p)[0])[:, : profile.n]


def _parameters(problem: BoundaryEquations, profile: Profile, times: Array) -> Array:
    p = np.tile(problem.full_parameters(profile.vector()), (len(times), 1))
    p[:, -1] = times
    return p
