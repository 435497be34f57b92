"""What is not followed of motions that slide on a surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.continuation.branch import SpecialPoint
from contin.errors import InputError

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem


def refuse_sliding(problem: EquilibriumProblem, point: SpecialPoint) -> None:
    """Raises InputError at a pseudo-equilibrium."""
    if problem.sliding is not None:
        raise InputError(
            f"{point.branch}.{point.label} is a pseudo-equilibrium on {problem.sliding.jump.surface.text}; cycles and "
            "curves in two parameters of the sliding motion are not followed"
        )
