"""What a run adds to the results on request: the orbits at labelled points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint


def sample_orbit(branch: Branch, point: SpecialPoint) -> Mapping[str, Any] | None:
    """The orbit at a labelled point: time and every state over one period; None where the point is no orbit."""
    from contin.problems.orbits.two_parameters import OfPeriodicOrbits

    if branch.kind != "orbit" and not isinstance(branch.problem, OfPeriodicOrbits):
        return None
    profile = branch.problem.profile(point.z)
    states = dict(zip(branch.problem.system.state_names, profile.u.T, strict=True))
    return {"t": profile.times * profile.period, **states}
