"""The branch of equilibria (fixed points) through a point of a curve of special points, in one parameter."""

from __future__ import annotations

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.model.advice import place_of_parameter
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.transitions.registry import born


@born(LocusProblem, "", "the branch of equilibria")
def equilibria_through(problem: LocusProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The branch of equilibria (fixed points) through a point of a locus, with one parameter free."""
    active = place_of_parameter(parameter, problem.system.parameter_names)
    p = problem.curve.full_parameters(point.z)
    branch = EquilibriumProblem(problem.system, p, active, problem.state_periods)
    scale = None
    if point.scale.size:  # at a singular point the branch itself does not tell typical sizes
        widths = dict(zip(problem.parameters, point.scale[[-1, -2]], strict=True))
        scale = np.append(point.scale[: problem.n], widths.get(parameter, max(1.0, abs(float(p[active])))))
    z = np.append(point.z[: problem.n], p[active])
    return [Seed(branch, z, scale=scale, parent=Parent.of(point))]
