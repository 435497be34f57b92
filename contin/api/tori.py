"""Invariant tori from Neimark-Sacker points: of a map invariant circles, of flows tori with two frequencies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.settled_tori import gathered, settled_torus
from contin.api.torus_branches import end_of, torus_branch, torus_plan
from contin.continuation.branch import Branch, End, Parent, SpecialPoint
from contin.continuation.settings import Settings
from contin.errors import InputError, NoSolutionError
from contin.kernels.clock import computing_time
from contin.lowering.system import CompiledSystem
from contin.model.model import Model
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.records import Record
from contin.simulate.flight import forcing_period
from contin.systems.iterate import IteratedSystem
from contin.tori.birth import born
from contin.tori.equations import Metric
from contin.tori.march import follow
from contin.tori.strobe import Strobe

NODES: Final = 15  # of the first circle, unless `intervals` fixes them
FIXED: Final = EquilibriumProblem | CycleProblem


def torus(
    origin: Any,
    parameter: str | Sequence[str],
    bounds: Mapping[str, tuple[float, float]] | tuple[float, float],
    *,
    start: str | Record | None = None,
    parameters: Record | None = None,
    direction: str = "both",
    name: str = "torus",
    settings: Settings | Record | None = None,
) -> Branch:
    """The family of invariant tori that is born at a Neimark-Sacker point, or on one of which a simulation settles.

    The torus is cut by the flow itself: its circle phi(u(s)) = u(s + rho) is that of the stroboscopic map (forced
    flows), of the return after a constant time T, an unknown (autonomous flows), or of the map itself.

    origin : a label NS of a family of periodic orbits, of fixed points or cycles of a map given by formulas; or a
        model, whose trajectory from `start` (with `parameters`) settles on a torus, which is followed to both sides.
    settings : `step`, `min_step`, `max_step` (the first is the size of the first torus, relative to that of the orbit),
        `steps` (rows), `max_angle`, `tolerance`, `intervals` (a fixed, odd number of nodes of the circle).

    Columns: the parameter, `rotation` (rho), `period` (T; flows), of each state `.min`, `.max`, `.norm` (root mean
    square) over the torus, `size` (of the circle, relative to the orbit's), `nodes`, `tail` (the part of the highest
    third of its Fourier modes), `error` (of its equations between the nodes, relative to its size), `stable`,
    `unstable` (exponents across the torus above zero). The first row of a
    family from a point is the point itself. Source: Schilder, Osinga and
    Vogt, SIAM J. Appl. Dyn. Syst. 4 (2005); Gomez and Mondelo, Physica D 157 (2001).
    """
    began = computing_time()
    varied = parameter if isinstance(parameter, str) else parameter[0]
    if not isinstance(parameter, str) and len(parameter) != 1:
        raise InputError("a torus is followed in one parameter; curves of NS points in two are loci: leave out `as`")
    limits = bounds[varied] if isinstance(bounds, Mapping) else bounds
    plan = torus_plan(settings, (float(limits[0]), float(limits[1])))
    if not isinstance(origin, SpecialPoint):
        return settled_torus(origin, start, parameters, varied, plan, direction, name)
    point = origin
    strobe, u, time, value, size = _origin(point, varied)
    if not limits[0] <= value <= limits[1]:
        raise InputError(f"{point.branch}.{point.label} is at {varied} = {value:.8g}, outside the range {limits}")
    metric = Metric(size, float(limits[1] - limits[0]))
    try:
        first, tangent = born(strobe, metric, u, time, value, plan.nodes or NODES)
        rows, stop = gathered(follow(strobe, metric, first, tangent, plan))
    except NoSolutionError as error:
        raise InputError(f"{point.branch}.{point.label}: no torus starts there: {error}") from None
    ends = (End("start", f"born at {point.branch}.{point.label}"), end_of(stop, varied))
    return torus_branch(
        name, strobe, metric, [first, *rows], ends, computing_time() - began,
        parent=Parent.of(point), unstable=float(point.values["unstable"]),
    )  # fmt: skip


def _origin(point: SpecialPoint, parameter: str) -> tuple[Strobe, Array, float, float, Array]:
    """The map, the point of it, its time, the parameter's value, and the sizes of the states."""
    problem = point.problem
    where = f"{point.branch}.{point.label}"
    if point.type != "NS" or not isinstance(problem, OrbitProblem | ShootingProblem | FIXED):
        raise InputError(
            f"{where}: tori are born at points NS of periodic orbits and of fixed points of maps, computed "
            "from formulas by collocation or shooting"
        )
    if isinstance(problem, CycleProblem):
        problem = problem.inner
    system = problem.system
    model = getattr(system, "model", None)
    if not isinstance(system, CompiledSystem | IteratedSystem) or not isinstance(model, Model):
        raise InputError(f"{where}: tori need a flow or map that is given by formulas")
    if model.mass or model.constraints is not None or model.events:
        raise InputError(f"{where}: tori of flows with a mass matrix or with jumps of the states are not followed")
    p = np.array(problem.full_parameters(point.z), dtype=float)[: system.m]
    active = system.parameter_names.index(parameter)
    turn = np.asarray(model.periods(dict(zip(system.parameter_names, p.tolist(), strict=True))), dtype=float)
    if isinstance(problem, EquilibriumProblem):
        u = np.asarray(point.z[: system.n], dtype=float)
        sizes = np.asarray(point.scale[: system.n], dtype=float) if len(point.scale) else np.ones(system.n)
        return Strobe(system, p, active, turn), u, 1.0, float(p[active]), sizes
    profile = problem.profile(point.z)
    time, states = float(profile.period), np.asarray(profile.u)
    assert isinstance(system, CompiledSystem)  # of a flow
    multiple = round(time / forcing_period(system, p)) if system.is_forced else 1
    spread = np.ptp(states, axis=0)
    sizes = np.where(spread > 1e-3 * np.abs(states).max(axis=0), spread, np.abs(states).max(axis=0))
    sizes = np.where(sizes > 0.0, sizes, sizes.max() or 1.0)
    return Strobe(system, p, active, turn, multiple), states[0].copy(), time, float(p[active]), sizes
