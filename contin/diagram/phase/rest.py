"""Total rest: the state in which everything but angles is zero, where the equations may have no derivatives.

In averaged equations it is an equilibrium in every form of the amplitudes, but a smooth point in some only. It is one
state, whatever the angles are.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.seed import Seed
from contin.diagram.phase.states import State, points_of
from contin.diagram.sizes import length, sizes_among
from contin.errors import ContinError
from contin.search.orbit_by_simulation import time_scale
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

NEAR: Final = (1e-4, 1e-6)  # of the states' sizes: where the rates must fall in proportion
PROPORTIONAL: Final = 3.0  # ... up to this factor
DIRECTIONS: Final = 6  # in which trajectories set out from beside it
TIME: Final = 300.0  # time scales
STEPS: Final = 20_000
CLEAR: Final = 3.0  # factor by which a trajectory must have grown, or shrunk
ZERO: Final = 1e-9  # of the states' sizes


def is_rest(problem: EquilibriumProblem, u: Array, sizes: Array) -> bool:
    """True where all states but angles are zero; sizes (n,) of the states."""
    moving = np.asarray(problem.angle_periods) == 0.0
    return bool(np.all(np.abs(u[moving]) <= ZERO * sizes[moving]))


def rest_state(problem: Any, states: Sequence[State], value: float) -> tuple[Seed | None, State | None]:
    """Total rest, where it is an equilibrium and no state yet: as a seed where the equations are smooth, else a state.

    Whether it is stable is told, where there are no derivatives, by trajectories from beside it; (None, None) where
    those do not agree.
    """
    if problem.system.kind == "map":
        return None, None
    sizes = sizes_among(problem, [points_of(s) for s in states], value)
    if any(not s.is_orbit and is_rest(problem, s.vector, sizes) for s in states):
        return None, None
    p = problem.full_parameters(np.append(np.zeros(problem.n), value))[: len(problem.base)]
    zero = np.zeros(problem.n)
    moving = np.asarray(problem.angle_periods) == 0.0
    f, matrix = problem.system.jacobian(zero, p)
    if np.all(np.isfinite(f)) and np.all(np.isfinite(matrix[:, : problem.n])) and moving.all():
        rates = np.abs(matrix[:, : problem.n]) @ sizes
        return (Seed(problem, np.append(zero, value)), None) if np.all(np.abs(f) <= ZERO * rates) else (None, None)
    starts = _beside(problem, moving)
    sizes = np.where(moving, sizes, 1.0)
    if not all(_falls(problem.system, u, p, moving, sizes) for u in starts):
        return None, None
    unstable = [_grows(problem.system, np.where(moving, NEAR[0] * sizes * u, u), p, moving, sizes) for u in starts]
    if any(one is None for one in unstable) and not any(one for one in unstable):
        return None, None
    values = dict(zip(problem.system.state_names, zero.tolist(), strict=True))
    return None, State(values, int(any(unstable)), zero)


def _beside(problem: EquilibriumProblem, moving: Vector) -> list[Array]:
    """Directions, angles anywhere; amplitudes with a lowest value of 0 are positive."""
    generator = np.random.default_rng(5)
    lowest = {floor.index for floor in problem.floors if not floor.together}
    found = []
    for _ in range(DIRECTIONS):
        u = generator.normal(size=problem.n)
        for k in range(problem.n):
            if not moving[k]:
                u[k] = generator.uniform(0.0, float(problem.angle_periods[k]))
            elif k in lowest or not moving.all():
                u[k] = abs(u[k])
        found.append(u)
    return found


def _falls(system: CompiledSystem, u: Array, p: Array, moving: Any, sizes: Array) -> bool:
    """True where the rates of all but angles fall in proportion to the distance from rest."""
    rates = []
    for near in NEAR:
        at = np.where(moving, near * sizes * u, u)
        f = system.value(at, p)[moving]
        if not np.all(np.isfinite(f)):
            return False
        rates.append(length(f, sizes[moving]) / near)
    return rates[1] <= PROPORTIONAL * rates[0]


def _grows(system: CompiledSystem, start: Array, p: Array, moving: Any, sizes: Array) -> bool | None:
    """Whether a trajectory from beside rest leaves it; None where it neither does nor comes nearer."""
    before = float(np.linalg.norm((start / sizes)[moving]))
    with suppress(ContinError, np.linalg.LinAlgError):  # neither: the answer for what cannot be followed is None
        scale = time_scale(system, start, p)
        options = {"rtol": 1e-8, "atol": 1e-10 * before * sizes, "budget": STEPS}
        times = np.linspace(0.0, TIME * scale, 61)
        path = integrate(system, start, p, TIME * scale, times=times, **options).u[:, moving]  # type: ignore[arg-type]
        lengths = np.linalg.norm(path / sizes[moving], axis=1)
        if float(lengths.max()) > CLEAR * CLEAR * CLEAR * before:
            return True
        return False if float(lengths[-1]) < before / CLEAR else None
    return None
