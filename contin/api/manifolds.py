"""Stable and unstable manifolds of equilibria and of fixed points, as branches of kind manifold."""

from __future__ import annotations

from typing import Any, Final, cast

import numpy as np

from contin.abi import Array
from contin.api.manifold_tables import branch_of, of_flow, of_map
from contin.api.manifolds_of_orbits import of_cycle, of_forced
from contin.api.starts import equilibrium
from contin.continuation.branch import Branch, SpecialPoint
from contin.errors import InputError
from contin.kernels.clock import computing_time
from contin.lowering.system import CompiledSystem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.manifolds.eigenspace import Eigenspace, Side, eigenspace
from contin.problems.manifolds.iterated import MapCurve, MapOfFormulas
from contin.problems.manifolds.segments import FromRest, Grower
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.records import Record
from contin.search.equilibrium_from_guess import Equilibrium

SIDES: Final = ("stable", "unstable")
SPACING: Final = 0.05  # of the length: between neighbouring segments of a surface
MOST_SAMPLES: Final = 10_000


def manifold(
    origin: Any,
    start: str | Record | None = None,
    parameters: Record | None = None,
    *,
    length: float,
    side: str = "unstable",
    dimension: int | None = None,
    spacing: float | None = None,
    samples: int = 200,
    name: str = "manifold",
) -> Branch:
    """The stable or unstable manifold of an equilibrium (of a fixed point of a map, where it is a curve).

    origin : a model, whose equilibrium is solved from `start`; a labelled point of a branch of equilibria; or one of a
        family of periodic orbits, whose surface along its one real multiplier on that side is grown (both sheets). Of a
        forced flow: the curve of the stroboscopic map, states at t = 0 modulo the orbit's period.
    length : arclength, in the states' own units, of every orbit on it, or of either branch of a curve.
    dimension : 1 or 2; by default that of the whole eigenspace. Below that, the strong manifold of the fastest rates.
        Of a cycle with several multipliers on that side, 2 asks for the surface of the strongest one.
    spacing : of a surface, the widest gap between neighbouring orbits at equal arclength (default length/20).
    samples : points along each orbit; of maps as many as angle and distance need.

    Columns: `orbit` (number of the segment), `angle` (of a surface), `s` (arclength from the equilibrium; on a curve
    negative on the branch that leaves against the eigenvector), `t` (flows; negative on a stable manifold), the states.
    """
    if side not in SIDES:
        raise InputError(f"side: 'stable' or 'unstable'; got {side!r}")
    if not (np.isfinite(length) and length > 0.0):
        raise InputError(f"length: a positive arclength; got {length!r}")
    if not 8 <= samples <= MOST_SAMPLES:
        raise InputError(f"samples: from 8 to {MOST_SAMPLES} points along each orbit; got {samples}")
    if spacing is not None and not spacing > 0.0:
        raise InputError(f"spacing: a positive distance; got {spacing!r}")
    began = computing_time()
    if isinstance(origin, SpecialPoint) and isinstance(origin.problem, OrbitProblem):
        if origin.problem.system.is_forced:
            return of_forced(origin, origin.problem, cast(Side, side), length, dimension, name, began)
        if dimension not in (None, 2):
            raise InputError("manifold: of a cycle, surfaces along a real multiplier are grown: leave out `dimension`")
        return of_cycle(
            origin, origin.problem, side, length, spacing or SPACING * length, samples, name, began, dimension == 2
        )
    system, u, p = _rest(origin, start, parameters)
    is_map = system.kind == "map"
    matrix = np.asarray(system.jacobian(u, p)[1])[:, : len(u)]
    space = eigenspace(matrix, cast(Side, side), dimension, is_map)
    if space.dimension > (1 if is_map else 2):
        raise InputError(
            f"manifold: the {side} manifold has {space.dimension} dimensions; "
            f"{'curves of maps' if is_map else 'curves and surfaces'} are grown: give `dimension: 1`"
            + ("" if is_map else " or 2")
        )
    if is_map:
        table, troubles = of_map(MapCurve(MapOfFormulas(system, u, p, length), u, space, length, side == "stable"))
    else:
        grower = Grower(system, p, FromRest(u, space), length, samples, side == "stable")
        table, troubles = of_flow(grower, u, space.dimension, spacing or SPACING * length)
    seconds = computing_time() - began
    return branch_of(name, system, u, p, table, troubles, seconds, f"{side} manifold, {_words(space)}")


def _rest(origin: Any, start: Any, parameters: Record | None) -> tuple[CompiledSystem, Array, Array]:
    """The system, its equilibrium and all parameters."""
    if isinstance(origin, SpecialPoint):
        problem = origin.problem
        if not isinstance(problem, EquilibriumProblem) or not isinstance(problem.system, CompiledSystem):
            raise InputError(
                f"{origin.branch}.{origin.label}: manifolds are grown from equilibria and fixed points of formulas"
            )
        p = np.array(problem.base, dtype=float)
        p[problem.active] = origin.z[-1]
        return problem.system, np.asarray(origin.z[:-1]), p
    found = equilibrium(origin, start, parameters)
    if not isinstance(found, Equilibrium) or not isinstance(found.system, CompiledSystem):
        raise InputError("manifolds need a flow or map that is given by formulas")
    return found.system, found.u, found.p


def _words(space: Eigenspace) -> str:
    return "rates " + ", ".join(f"{value:.6g}" if value.imag else f"{value.real:.6g}" for value in space.values)
