"""Invariant tori from Neimark-Sacker points: of a map invariant circles, of flows tori with two frequencies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import Branch, End, Parent, SpecialPoint
from contin.continuation.settings import Settings
from contin.errors import InputError, NoSolutionError
from contin.kernels.clock import computing_time
from contin.lowering.system import CompiledSystem
from contin.machine import elementary
from contin.model.model import Model
from contin.problems.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.shooting.problem import ShootingProblem
from contin.records import Record
from contin.simulate.flight import forcing_period
from contin.systems.iterate import IteratedSystem
from contin.tori.birth import born
from contin.tori.equations import Circle, Metric
from contin.tori.looks import look
from contin.tori.march import Plan, Row, Stop, follow
from contin.tori.normal import exponents
from contin.tori.strobe import Strobe

NODES: Final = 15  # of the first circle, unless `intervals` fixes them
STEPS: Final = 200  # rows, unless the settings say otherwise
FIXED: Final = EquilibriumProblem | CycleProblem
STEP, LARGEST_STEP = 0.01, 0.05


def torus(
    point: SpecialPoint,
    parameter: str | Sequence[str],
    bounds: Mapping[str, tuple[float, float]] | tuple[float, float],
    *,
    name: str = "torus",
    settings: Settings | Record | None = None,
) -> Branch:
    """The family of invariant tori that is born at a Neimark-Sacker point, in one parameter.

    The torus is cut by the flow itself: its circle phi(u(s)) = u(s + rho) is that of the stroboscopic map (forced
    flows), of the return after a constant time T, an unknown (autonomous flows), or of the map itself.

    point : a label NS of a family of periodic orbits or of fixed points of a map given by formulas.
    settings : `step`, `min_step`, `max_step` (the first is the size of the first torus, relative to that of the orbit),
        `steps` (rows), `max_angle`, `tolerance`, `intervals` (a fixed, odd number of nodes of the circle).

    Columns: the parameter, `rotation` (rho), `period` (T; flows), of each state `.min`, `.max`, `.norm` (root mean
    square) over the torus, `size` (of the circle, relative to the orbit's), `nodes`, `tail` (the part of the highest
    third of its Fourier modes), `error` (of its equations between the nodes, relative to its size), `stable`,
    `unstable` (exponents across the torus above zero). The first row is the point itself. Source: Schilder, Osinga and
    Vogt, SIAM J. Appl. Dyn. Syst. 4 (2005); Gomez and Mondelo, Physica D 157 (2001).
    """
    began = computing_time()
    varied = parameter if isinstance(parameter, str) else parameter[0]
    if not isinstance(parameter, str) and len(parameter) != 1:
        raise InputError("a torus is followed in one parameter; curves of NS points in two are loci: leave out `as`")
    limits = bounds[varied] if isinstance(bounds, Mapping) else bounds
    strobe, u, time, value, size = _origin(point, varied)
    if not limits[0] <= value <= limits[1]:
        raise InputError(f"{point.branch}.{point.label} is at {varied} = {value:.8g}, outside the range {limits}")
    plan = _plan(settings, (float(limits[0]), float(limits[1])))
    metric = Metric(size, float(limits[1] - limits[0]))
    rows: list[Row] = []
    try:
        first, tangent = born(strobe, metric, u, time, value, plan.nodes or NODES)
        end = Stop("corrector", "no torus is found")
        for found in follow(strobe, metric, first, tangent, plan):
            if isinstance(found, Stop):
                end = found
            else:
                rows.append(found)
    except NoSolutionError as error:
        raise InputError(f"{point.branch}.{point.label}: no torus starts there: {error}") from None
    return _branch(name, point, strobe, metric, first, rows, end, computing_time() - began)


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


def _plan(given: Settings | Record | None, bounds: tuple[float, float]) -> Plan:
    """The settings; what was not written has defaults of its own."""
    written = dict(given) if isinstance(given, Mapping) else {}
    of = Settings.of(given)
    default = not isinstance(given, Settings)
    largest = LARGEST_STEP if default and "max_step" not in written else of.max_step
    step = STEP if default and "step" not in written else of.step
    steps = STEPS if default and "steps" not in written else of.steps
    nodes = None if of.intervals is None else of.intervals | 1
    least = max(of.min_step, 1e-3 * step) if "min_step" not in written else of.min_step
    return Plan(bounds, min(step, largest), least, largest, steps, of.max_angle, of.newton_tolerance, nodes)


def _branch(
    name: str, point: SpecialPoint, strobe: Strobe, metric: Metric, first: Circle, rows: Sequence[Row], end: Stop,
    seconds: float,
) -> Branch:  # fmt: skip
    """Columns of all rows; the first is the point, a torus without size."""
    began = computing_time()
    names, parameter = strobe.system.state_names, strobe.system.parameter_names[strobe.active]
    table: dict[str, list[float]] = {}
    spectra: list[Array] = []
    for k, circle in enumerate([first, *[row.circle for row in rows]]):
        seen = look(strobe, metric, circle)
        across = np.empty(0) if k == 0 else exponents(strobe, metric, circle, rows[k - 1].solved.jacobians)
        entry: dict[str, float] = {parameter: circle.value, "rotation": circle.rho}
        entry |= {} if strobe.is_map else {"period": circle.time}
        for i, state in enumerate(names):
            entry |= {f"{state}.min": seen.least[i], f"{state}.max": seen.greatest[i], f"{state}.norm": seen.norm[i]}
        entry["size"] = metric.amplitude(circle) if k else 0.0
        entry |= {"nodes": circle.count, "tail": rows[k - 1].tail if k else 0.0, "error": seen.error if k else 0.0}
        entry["unstable"] = float(np.sum(across > 0.0)) if k else float(point.values.get("unstable", np.nan))
        for key, number in entry.items():
            table.setdefault(key, []).append(float(number))
        spectra.append(across)
    columns: dict[str, Vector] = {key: np.array(column) for key, column in table.items()}
    columns["nodes"] = columns["nodes"].astype(np.int64)
    columns["unstable"] = columns["unstable"].astype(np.int64)
    columns["stable"] = columns["unstable"] == 0
    z = np.column_stack([columns[f"{state}.max"] for state in names] + [columns[parameter]])
    data: dict[str, object] = {} if end.at is None else {"at": {parameter: end.at}}
    if end.locked is not None:
        data["rotation"] = {"p": end.locked.p, "q": end.locked.q}
        if end.locked.error is not None:
            data["error"] = end.locked.error
    moduli = elementary.exp(np.array([spectra[-1] * np.nan if k == 0 else one for k, one in enumerate(spectra)]))
    problem = EquilibriumProblem(strobe.system, strobe.base, strobe.active)
    ends = (End("start", f"born at {point.branch}.{point.label}"), End(end.reason, end.text, data))
    return Branch(
        name, "torus", (parameter,), columns, (), ends, z, np.zeros_like(z), moduli.astype(complex), 0, len(rows),
        seconds + computing_time() - began, {}, problem, parent=Parent(point.branch, point.label),
        notes=_notes(columns, parameter),
    )  # fmt: skip


def _notes(columns: Mapping[str, Any], parameter: str) -> tuple[str, ...]:
    """Rows whose circles are less sure than the others."""
    poor = np.flatnonzero(columns["error"] > 1e-4)
    if not len(poor):
        return ()
    worst = int(poor[np.argmax(columns["error"][poor])])
    return (
        f"{len(poor)} of {len(columns['error'])} tori have an error above 1e-4 of their size, the largest "
        f"{columns['error'][worst]:.2g} at {parameter} = {columns[parameter][worst]:.8g}",
    )
