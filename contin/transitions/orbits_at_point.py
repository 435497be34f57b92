"""What births on families of periodic orbits share: the parameter along which they start, what is unstable."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from contin.continuation.branch import SpecialPoint
from contin.errors import InputError
from contin.model.advice import place_of_parameter
from contin.problems.scales import parameter_width

if TYPE_CHECKING:
    from contin.continuation.problem import Problem
    from contin.problems.orbits.family import FamilyOfOrbits


Family = TypeVar("Family", bound="FamilyOfOrbits")


def along_own_parameter(problem: Problem, point: SpecialPoint, parameter: str) -> None:
    """Raises InputError where another parameter is asked for than the one along which the point was found."""
    if parameter != problem.parameters[0]:
        raise InputError(
            f"{point.branch}.{point.label}: a new family starts along {problem.parameters[0]}; vary another parameter "
            "from one of its orbits"
        )


def in_another(problem: Family, point: SpecialPoint, parameter: str) -> tuple[Family, SpecialPoint]:
    """The same orbit with another parameter free: the doubled orbits are born along every one that moves the point."""
    if parameter == problem.parameters[0]:
        return problem, point
    place_of_parameter(parameter, problem.system.parameter_names, f"{point.branch}.{point.label}: ")
    other = problem.with_active(parameter, point.z)
    z, scale = point.z.copy(), point.scale.copy()
    z[-1] = other.base[other.active]
    bounds = other.default_range(parameter)
    scale[-1] = parameter_width(other.system.model, parameter, float(z[-1]), bounds or (-np.inf, np.inf))
    return other, replace(point, z=z, scale=scale)


def unstable_count(point: SpecialPoint) -> int:
    """Multipliers outside the unit circle at the point, the critical one not counted."""
    values = np.abs(point.eigenvalues)
    return int(np.sum(values > 1.0 + 1e-4))
