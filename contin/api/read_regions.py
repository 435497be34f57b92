"""A phase diagram from a file, as it was: curves, regions with their states, neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from contin.continuation.branch import Branch
from contin.diagram.phase.checks import Check
from contin.diagram.phase.diagram import PhaseDiagram
from contin.diagram.phase.lines import Box
from contin.diagram.phase.phase_data import Region
from contin.diagram.phase.states import State
from contin.errors import InputError
from contin.records import Record


def phase_of(document: Record, branches: Sequence[Branch], notes: Sequence[str]) -> PhaseDiagram:
    """The phase diagram of a result document, whose curves are among the branches. InputError where it is damaged."""
    data = document["phase"]
    try:
        parameters = cast("tuple[str, str]", tuple(data["parameters"]))
        box = cast("Box", tuple(tuple(float(v) for v in data["range"][name]) for name in parameters))
        kind = document["model"].get("kind", "flow")
        regions = tuple(_region(region, kind) for region in data["regions"])
        borders = {
            cast("tuple[int, int]", tuple(border["regions"])): frozenset(border["curves"]) for border in data["borders"]
        }
        check = data.get("check", {})
        counts = Check(check.get("followed", 0), ("",) * check.get("disagreed", 0), check.get("orbits", 0))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"the regions of the phase diagram are damaged in the file: {error}") from None
    curves = tuple(branch for branch in branches if branch.name in data["curves"])
    others = tuple(branch for branch in branches if branch.name not in data["curves"])
    return PhaseDiagram(parameters, box, curves, regions, borders, others, tuple(notes), check=counts)


def _region(stored: Record, kind: str) -> Region:
    return Region(
        stored["name"], stored["number"], stored["point"], tuple(_state(state, kind) for state in stored["states"]),
        stored["area"], np.array(stored["outline"], dtype=float).reshape(-1, 2),
        tuple(np.array(hole, dtype=float).reshape(-1, 2) for hole in stored["holes"]), stored.get("aperiodic", 0), kind,
    )  # fmt: skip


def _state(stored: Record, kind: str) -> State:
    values = {str(name): float("nan") if value is None else float(value) for name, value in stored["values"].items()}
    what = stored.get("kind", "equilibrium")
    vector = np.array([] if what == "orbit" else list(values.values()))
    orbit = (None, np.empty(0)) if what == "orbit" else None
    steps = int(values["period"]) if what == "cycle" else 1
    return State(values, int(stored["unstable"]), vector, int(stored["copies"]), orbit, steps)
