"""What a result document says of the model, and of the orbits at labelled points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint
    from contin.runs.plan import Plan


def describe_model(plan: Plan) -> dict[str, Any]:
    """The `model` entry: names, the parameter values runs start from, units and periods of angles where declared."""
    model = plan.model
    described: dict[str, Any] = {
        "name": model.name,
        "states": list(model.state_names),
        "parameters": model.default_parameters(plan.parameters),
    }
    if plan.title:
        described["title"] = plan.title
    units = {p.name: p.unit for p in model.parameters if p.unit} | {s.name: s.unit for s in model.states if s.unit}
    if units:
        described["units"] = units
    periods = dict(zip(model.state_names, model.periods(plan.parameters), strict=True))
    angles = {name: float(period) for name, period in periods.items() if period > 0}
    if angles:
        described["periods"] = angles
    return described


def sample_orbit(branch: Branch, point: SpecialPoint) -> Mapping[str, Any] | None:
    """The orbit at a labelled point: time and every state over one period; None where the point is no orbit."""
    if branch.kind != "orbit":
        return None
    orbit: Mapping[str, Any] = branch.problem.orbit(point.z)
    return orbit
