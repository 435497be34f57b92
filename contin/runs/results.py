"""What a run adds to the results on request: the orbits at labelled points."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from contin.continuation.defects import noted
from contin.problems.orbits.two_parameters import OfPeriodicOrbits
from contin.records import Record

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint


class OrbitSamples:
    """The orbit at a labelled point: time and every state over one period; None where the point is no orbit.

    Called with a branch and a point. What cannot be sampled is told in words, and costs no other result.
    """

    def __init__(self, tell: Callable[[str], object]) -> None:
        self.tell = tell

    def __call__(self, branch: Branch, point: SpecialPoint) -> Record | None:
        found: list[Record | None] = [None]
        with noted(lambda text: self.tell(f"{branch.name}.{point.label}: its orbit is not written: {text}")):
            found = [_sampled(branch, point)]
        return found[0]


def _sampled(branch: Branch, point: SpecialPoint) -> Record | None:
    if branch.kind != "orbit" and not isinstance(branch.problem, OfPeriodicOrbits):
        return None
    profile = branch.problem.profile(point.z)
    states = dict(zip(branch.problem.system.state_names, profile.u.T, strict=True))
    return {"t": profile.times * profile.period, **states}
