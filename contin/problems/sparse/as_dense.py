"""A large model made of formulas, or a small sparse function, as the dense problem that it is too."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.lowering import compile_system
from contin.problems.equilibria.equilibrium import EquilibriumProblem

if TYPE_CHECKING:
    from contin.problems.sparse.large_equilibrium import LargeProblem

MOST: Final = 400  # states; dense kernels of more would run for hours
SMALL: Final = 20  # states up to which a function's dense Jacobian costs nothing, whatever form it has


def dense_problem(problem: LargeProblem) -> EquilibriumProblem | None:
    """The same equations with the same parameter free; None beyond `MOST` states, of a user's function `SMALL`."""
    written = problem.system.model.written
    if problem.n > (SMALL if written is None else MOST):
        return None
    if written is None:
        return EquilibriumProblem(problem.system, problem.base, problem.active, problem.angle_periods)
    return EquilibriumProblem(compile_system(written), problem.base, problem.active, problem.angle_periods)
