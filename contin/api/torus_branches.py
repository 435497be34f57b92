"""Families of tori as branches: settings, columns, ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import Branch, End, Parent
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.records import Record
from contin.tori.ends import Row, Stop
from contin.tori.equations import Circle, Metric
from contin.tori.looks import look
from contin.tori.march import Plan
from contin.tori.normal import exponents
from contin.tori.strobe import Strobe

STEPS: Final = 200  # rows in each direction, unless the settings say otherwise
STEP, LARGEST_STEP = 0.01, 0.05


def torus_plan(given: Settings | Record | None, bounds: tuple[float, float]) -> Plan:
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


def torus_branch(
    name: str, strobe: Strobe, metric: Metric, rows: Sequence[Circle | Row], ends: tuple[End, End], seconds: float, *,
    start_row: int = 0, parent: Parent | None = None, unstable: float = np.nan,
) -> Branch:  # fmt: skip
    """Columns of all rows; one that is a mere circle is a point NS, a torus without size (`unstable`: its count)."""
    parameter, names = strobe.system.parameter_names[strobe.active], strobe.system.state_names
    table: dict[str, list[float]] = {}
    spectra: list[Array] = []
    for row in rows:
        entry, across = _entry(strobe, metric, row, unstable)
        for key, number in entry.items():
            table.setdefault(key, []).append(float(number))
        spectra.append(across)
    columns: dict[str, Vector] = {key: np.array(column) for key, column in table.items()}
    columns["nodes"] = columns["nodes"].astype(np.int64)
    columns["unstable"] = columns["unstable"].astype(np.int64)
    columns["stable"] = columns["unstable"] == 0
    z = np.column_stack([columns[f"{state}.max"] for state in names] + [columns[parameter]])
    moduli = elementary.exp(np.array(spectra)).astype(complex)
    problem = EquilibriumProblem(strobe.system, strobe.base, strobe.active)
    return Branch(
        name, "torus", (parameter,), columns, (), ends, z, np.zeros_like(z), moduli, start_row, len(rows) - 1,
        seconds, {}, problem, parent=parent, notes=_notes(columns, parameter),
    )  # fmt: skip


def _entry(strobe: Strobe, metric: Metric, row: Circle | Row, unstable: float) -> tuple[dict[str, float], Array]:
    """Columns of a row, and the exponents across its torus."""
    parameter = strobe.system.parameter_names[strobe.active]
    circle = row.circle if isinstance(row, Row) else row
    seen = look(strobe, metric, circle)
    entry: dict[str, float] = {parameter: circle.value, "rotation": circle.rho}
    entry |= {} if strobe.is_map else {"period": circle.time}
    for i, state in enumerate(strobe.system.state_names):
        entry |= {f"{state}.min": seen.least[i], f"{state}.max": seen.greatest[i], f"{state}.norm": seen.norm[i]}
    if not isinstance(row, Row):
        entry |= {"size": 0.0, "nodes": circle.count, "tail": 0.0, "error": 0.0, "unstable": unstable}
        return entry, np.full(max(strobe.n - 1 - strobe.free_time, 0), np.nan)
    across = exponents(strobe, metric, circle, row.solved.jacobians)
    entry |= {"size": metric.amplitude(circle), "nodes": circle.count, "tail": row.tail, "error": seen.error}
    entry["unstable"] = float(np.sum(across > 0.0))
    return entry, across


def end_of(stop: Stop, parameter: str) -> End:
    """A family's end with what belongs to it as data."""
    data: dict[str, object] = {} if stop.at is None else {"at": {parameter: stop.at}}
    if stop.locked is not None:
        data["rotation"] = {"p": stop.locked.p, "q": stop.locked.q}
        if stop.locked.error is not None:
            data["error"] = stop.locked.error
    return End(stop.reason, stop.text, data)


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
