"""What a run adds to the results on request: the orbits, or the fields, at labelled points."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from contin.continuation.defects import noted
from contin.continuation.fields import fields_along, has_fields
from contin.records import Record

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint
    from contin.problems.orbits.mesh.layout import Profile


class OrbitSamples:
    """{"orbit": ...} at a labelled point: time and every state over a period; {"fields": ...} of a model of kind: pde;
    None where the point has neither.

    Called with a branch and a point. What cannot be sampled is told in words, and costs no other result.
    """

    def __init__(self, tell: Callable[[str], object]) -> None:
        self.tell = tell

    def __call__(self, branch: Branch, point: SpecialPoint) -> Record | None:
        found: list[Record | None] = [None]
        with noted(lambda text: self.tell(f"{branch.name}.{point.label}: its orbit or fields are not written: {text}")):
            found = [_sampled(branch, point)]
        return found[0]


def _sampled(branch: Branch, point: SpecialPoint) -> Record | None:
    problem: Any = branch.problem
    if branch.kind == "bvp":
        return {"orbit": problem.functions_at(point.z)}
    if branch.kind != "orbit" and has_fields(problem):
        return {"fields": point.fields}
    profile: Profile | None = problem.profile(point.z) if branch.kind == "orbit" else problem.orbit_at(point.z)
    if profile is None:
        return None
    if has_fields(problem):
        fields = fields_along(problem, profile.u, point.values)
        return {"orbit": {"t": profile.times * profile.period, **fields}}
    names = problem.system.state_names[: profile.u.shape[1]]  # of a connection to a cycle, the model
    states = dict(zip(names, profile.u.T, strict=True))
    return {"orbit": {"t": profile.times * profile.period, **states}}
