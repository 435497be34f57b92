"""Functions of the parameters alone whose signs choose formulas: where one changes, the equations may jump."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Problem, in_two_parameters
from contin.lowering.switching import switching_functions
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, symbols_in
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.model.printing import to_text


def choices_of(problem: Problem, z: Array) -> tuple[Sequence[str], Array]:
    """See `Problem.choices`; of what is no model of formulas nothing is known."""
    model = problem.formulas
    functions = kept_with(model, "choices", lambda: _functions(model)) if isinstance(model, Model) else ()
    if not functions:
        return (), np.empty((len(z), 0))
    constants = problem.constants()
    rows = {name: np.full(len(z), constants[name]) for name in symbols_in(functions) if name in constants}
    for name in problem.free_names:
        rows[name] = problem.column(name, z)
    parameters = problem.parameters
    rows[parameters[0]] = z[:, -1]
    if in_two_parameters(problem):
        walls = problem.walls
        for (index, _, _), name in zip(walls, reversed(parameters[: len(walls)]), strict=True):
            rows[name] = z[:, index]
    values = [evaluate_all(functions, {name: float(row[k]) for name, row in rows.items()}) for k in range(len(z))]
    return [f"{to_text(function)} = 0" for function in functions], np.array(values, dtype=float)


def _functions(model: Model) -> tuple[Expression, ...]:
    formulas = [*model.equations, *(condition.residual for condition in model.conditions)]
    names = model.parameter_names
    alone = [f for f in switching_functions(formulas, names) if set(symbols_in([f])) <= set(names)]
    return tuple(alone)
