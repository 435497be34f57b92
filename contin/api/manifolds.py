"""Stable and unstable manifolds of equilibria and of fixed points, as branches of kind manifold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, cast

import numpy as np

from contin.abi import Array, Vector
from contin.api.starts import equilibrium
from contin.continuation.branch import Branch, End, SpecialPoint
from contin.errors import InputError
from contin.kernels.clock import computing_time
from contin.lowering.system import CompiledSystem
from contin.problems.equilibrium import EquilibriumProblem
from contin.problems.manifolds.eigenspace import Eigenspace, Side, eigenspace
from contin.problems.manifolds.iterated import Grown, MapCurve
from contin.problems.manifolds.segments import FromCycle, FromRest, Grower, Segment, curve, disc
from contin.problems.orbits.cycle_ends import Cycle
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.start import Equilibrium
from contin.records import Record

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
        family of periodic orbits, whose surface along its one real multiplier on that side is grown (both sheets).
    length : arclength, in the states' own units, of every orbit on it, or of either branch of a curve.
    dimension : 1 or 2; by default that of the whole eigenspace. Below that, the strong manifold of the fastest rates.
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
        if dimension not in (None, 2):
            raise InputError("manifold: of a cycle, surfaces along a real multiplier are grown: leave out `dimension`")
        return _of_cycle(origin, origin.problem, side, length, spacing or SPACING * length, samples, name, began)
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
        table, troubles = _of_map(MapCurve(system, u, p, space, length, side == "stable"))
    else:
        grower = Grower(system, p, FromRest(u, space), length, samples, side == "stable")
        table, troubles = _of_flow(grower, u, space.dimension, spacing or SPACING * length)
    seconds = computing_time() - began
    return _branch(name, system, u, p, table, troubles, seconds, f"{side} manifold, {_words(space)}")


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


Table = dict[str, Vector]


def _of_flow(grower: Grower, u0: Array, dimension: int, spacing: float) -> tuple[Table, list[str]]:
    """Columns, the states as "u", and what is not as asked for."""
    troubles: list[str] = []
    if dimension == 1:
        left, right = curve(grower)
        middle = Segment(0.0, np.zeros(1), np.zeros(1), u0[None], True)
        parts = [(left, -1.0, slice(None, None, -1)), (middle, 1.0, slice(None)), (right, 1.0, slice(None))]
        table = {
            "orbit": np.concatenate([np.full(len(one.s), k) for k, (one, _, _) in enumerate(parts)]),
            "s": np.concatenate([sign * one.s[order] for one, sign, order in parts]),
            "t": np.concatenate([one.t[order] for one, _, order in parts]),
            "u": np.concatenate([one.u[order] for one, _, order in parts]),
        }
        segments: Sequence[Segment] = (left, right)
    else:
        segments, widest = disc(grower, spacing)
        table = _surface(segments, grower.samples)
        if widest > spacing:
            troubles.append(
                f"neighbouring orbits part by up to {widest:.3g}, more than the spacing of {spacing:.3g}: their starts "
                "are as near as rounding or the number of orbits allows"
            )
    return table, troubles + _short(segments)


def _surface(segments: Sequence[Segment], samples: int) -> Table:
    return {
        "orbit": np.repeat(np.arange(len(segments)), samples),
        "angle": np.repeat([one.angle for one in segments], samples),
        "s": np.concatenate([one.s for one in segments]),
        "t": np.concatenate([one.t for one in segments]),
        "u": np.concatenate([one.u for one in segments]),
    }


def _short(segments: Sequence[Segment]) -> list[str]:
    short = [one for one in segments if not one.whole]
    if not short:
        return []
    least = min(float(one.s[-1]) for one in short)
    return [f"{len(short)} of {len(segments)} orbits come to rest before the length is reached, one at {least:.6g}"]


def _of_cycle(
    point: SpecialPoint, problem: OrbitProblem, side: str, length: float, spacing: float, samples: int, name: str,
    began: float,
) -> Branch:  # fmt: skip
    """Both sheets of the surface that belongs to the one multiplier outside (inside) the unit circle."""
    system, p = problem.system, problem.full_parameters(point.z)
    if not isinstance(system, CompiledSystem) or system.n_switches or system.model.forcing is not None:
        raise InputError("manifold: cycles of smooth autonomous flows given by formulas have surfaces that are grown")
    cycle = Cycle(system, p, problem.profile(point.z))
    multipliers = cycle.outside(side == "unstable")
    if len(multipliers) != 1:
        listed = ", ".join(f"{m:.6g}" for m in cycle.multipliers)
        raise InputError(
            f"manifold: {point.branch}.{point.label} has {len(multipliers)} {side} multipliers besides 1 ({listed}); "
            "surfaces are grown where there is one"
        )
    multiplier = multipliers[0]
    segments: list[Segment] = []
    troubles: list[str] = []
    for sense in (1.0, -1.0)[: 2 if multiplier > 0.0 else 1]:
        grower = Grower(system, p, FromCycle(cycle, multiplier, sense), length, samples, side == "stable")
        ring, widest = disc(grower, spacing)
        segments += ring
        if widest > spacing:
            troubles.append(f"neighbouring orbits part by up to {widest:.3g}, more than the spacing of {spacing:.3g}")
    table = _surface(segments, samples)
    words = f"{side} manifold of a cycle, multiplier {multiplier:.6g}, period {cycle.period:.6g}"
    seconds = computing_time() - began
    troubles += _short(segments)
    return _branch(name, system, cycle.states[0], p, table, troubles, seconds, words, "cycle through")


def _of_map(grower: MapCurve) -> tuple[Table, list[str]]:
    left, right = grower.branch(-1.0), grower.branch(1.0)
    middle = Grown(np.zeros(1), grower.u0[None], "")
    table = {
        "orbit": np.repeat([0, 1, 2], [len(left.s), 1, len(right.s)]),
        "s": np.concatenate([-left.s[::-1], middle.s, right.s]),
        "u": np.concatenate([left.u[::-1], middle.u, right.u]),
    }
    troubles = [
        f"the branch {sense} the eigenvector ends at arclength {one.s[-1]:.6g}: {one.trouble}"
        for sense, one in (("against", left), ("along", right)) if one.trouble
    ]  # fmt: skip
    return table, troubles


def _branch(
    name: str, system: CompiledSystem, u: Array, p: Array, table: Table, troubles: list[str], seconds: float, what: str,
    of: str = "equilibrium",
) -> Branch:  # fmt: skip
    states = table.pop("u")
    columns = {**table, **{state: states[:, k].copy() for k, state in enumerate(system.state_names)}}
    place = ", ".join(f"{state} = {value:.8g}" for state, value in zip(system.state_names, u, strict=True))
    end = End("bound", f"{what} of the {of} {place}")
    rows = len(states)
    z = np.column_stack([states, np.full(rows, p[0] if len(p) else 0.0)])
    return Branch(
        name, "manifold", (), columns, (), (end, end), z, np.zeros_like(z), np.zeros((rows, 0), complex), 0, rows,
        seconds, {}, EquilibriumProblem(system, p, 0), notes=tuple(troubles),
    )  # fmt: skip


def _words(space: Eigenspace) -> str:
    return "rates " + ", ".join(f"{value:.6g}" if value.imag else f"{value.real:.6g}" for value in space.values)
