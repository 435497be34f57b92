"""A large model made of formulas as the dense problem that it is too, for what large problems have no method for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.lowering import compile_system
from contin.problems.equilibrium import EquilibriumProblem

if TYPE_CHECKING:
    from contin.problems.sparse.problem import LargeProblem

MOST: Final = 400  # states; dense kernels of more would run for hours


def dense_problem(problem: LargeProblem) -> EquilibriumProblem | None:
    """The same equations with the same parameter free; None for a user's function, and beyond `MOST` states."""
    written = problem.system.model.written
    if written is None or problem.n > MOST:
        return None
    return EquilibriumProblem(compile_system(written), problem.base, problem.active, problem.angle_periods)
