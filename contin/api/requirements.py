"""What a start of branches needs of its model, else an error in words."""

from __future__ import annotations

from contin.errors import InputError
from contin.model.model import Model
from contin.systems.functions.function_problem import FunctionProblem


def need_parameters(model: Model) -> None:
    """A solution is one of a branch, whose last unknown is a parameter."""
    if not model.parameter_names:
        raise InputError(
            f"model {model.name!r} has no parameters, and so no branches of solutions: declare one, such as "
            "parameters: {p: 0}; trajectories need none (`contin simulate`)"
        )


def refuse_forced(model: Model | FunctionProblem) -> None:
    """Raises InputError for a flow whose equations know the time: it has no equilibria."""
    if getattr(model, "forcing", None) is not None:
        raise InputError(
            f"model {model.name!r} is forced periodically and has no equilibria: its periodic responses are followed "
            "by a diagram, by contin.periodic_orbit in Python, and by `as: orbit` in a run file"
        )
