"""Stable and unstable manifolds of periodic orbits: surfaces of cycles, curves of forced flows' stroboscopic maps."""

from __future__ import annotations

import numpy as np

from contin.api.manifold_tables import branch_of, of_map, of_surface, too_short
from contin.continuation.branch import Branch, SpecialPoint
from contin.errors import InputError
from contin.kernels.clock import computing_time
from contin.lowering.system import CompiledSystem
from contin.problems.manifolds.eigenspace import Side, eigenspace
from contin.problems.manifolds.iterated import MapCurve
from contin.problems.manifolds.segments import FromCycle, Grower, Segment, disc
from contin.problems.manifolds.stroboscope import Stroboscope
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.rests_and_cycles import Cycle


def of_forced(
    point: SpecialPoint, problem: OrbitProblem, side: Side, length: float, dimension: int | None, name: str,
    began: float,
) -> Branch:  # fmt: skip
    """The curve of the stroboscopic map through the orbit's state at t = 0."""
    system, p, profile = problem.system, problem.full_parameters(point.z), problem.profile(point.z)
    if not isinstance(system, CompiledSystem) or system.n_switches:
        raise InputError("manifold: orbits of smooth forced flows given by formulas have curves that are grown")
    strobe = Stroboscope(system, p[: system.m], profile.period, np.asarray(problem.winding, dtype=float), length)
    u, matrix = strobe.fixed_point(profile.u[0])
    space = eigenspace(matrix, side, dimension, by_multipliers=True)
    if space.dimension > 1:
        raise InputError(
            f"manifold: the {side} manifold of the stroboscopic map has {space.dimension} dimensions; curves are "
            "grown: give `dimension: 1`"
        )
    table, troubles = of_map(MapCurve(strobe, u, space, length, side == "stable"))
    multiplier = space.values[0].real
    words = f"{side} manifold of the stroboscopic map, period {profile.period:.6g}, multiplier {multiplier:.6g}"
    seconds = computing_time() - began
    return branch_of(name, system, u, strobe.p, table, troubles, seconds, words, "fixed point")


def of_cycle(
    point: SpecialPoint, problem: OrbitProblem, side: str, length: float, spacing: float, samples: int, name: str,
    began: float, strong: bool,
) -> Branch:  # fmt: skip
    """Both sheets of the surface that belongs to the one multiplier outside (inside) the unit circle.

    strong : of several the one farthest from the unit circle, if it is real.
    """
    system, p = problem.system, problem.full_parameters(point.z)
    if not isinstance(system, CompiledSystem) or system.n_switches:
        raise InputError("manifold: cycles of smooth autonomous flows given by formulas have surfaces that are grown")
    cycle = Cycle(system, p, problem.profile(point.z))
    if strong:
        multiplier = cycle.strongest(side == "unstable")
    else:
        multipliers = cycle.outside(side == "unstable")
        if len(multipliers) != 1:
            listed = ", ".join(f"{m:.6g}" for m in cycle.multipliers)
            raise InputError(
                f"manifold: {point.branch}.{point.label} has {len(multipliers)} {side} multipliers besides 1 "
                f"({listed}); surfaces are grown where there is one, or of the strongest: `dimension: 2`"
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
    table = of_surface(segments, samples)
    words = f"{side} manifold of a cycle, multiplier {multiplier:.6g}, period {cycle.period:.6g}"
    seconds = computing_time() - began
    troubles += too_short(segments)
    return branch_of(name, system, cycle.states[0], p, table, troubles, seconds, words, "cycle through")
