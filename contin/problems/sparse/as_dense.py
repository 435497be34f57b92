"""A large model made of formulas, or a small sparse function, as the dense problem that it is too."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.lowering import compile_system
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.systems.functions.function_system import FunctionSystem

if TYPE_CHECKING:
    from contin.problems.sparse.large_equilibrium import LargeProblem

MOST: Final = 400  # states; dense kernels of more would run for hours
SMALL: Final = 20  # states up to which a function's dense Jacobian costs nothing, whatever form it has


def divided(system: FunctionSystem) -> FunctionSystem:
    """Of a function with a regular mass matrix that is kept: u' = M^-1 F; else itself."""
    model = system.model
    return system if model.mass_matrix is None else FunctionSystem(model.divided())


def dense_problem(problem: LargeProblem) -> EquilibriumProblem | None:
    """The same equations with the same parameter free; None beyond `MOST` states, of a user's function `SMALL`."""
    written = problem.system.model.written
    if problem.n > (SMALL if written is None else MOST) or problem.system.model.has_singular_mass:
        return None
    if written is None:
        return EquilibriumProblem(divided(problem.system), problem.base, problem.active, problem.angle_periods)
    return EquilibriumProblem(compile_system(written), problem.base, problem.active, problem.angle_periods)
