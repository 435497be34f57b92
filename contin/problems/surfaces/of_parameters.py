"""Functions that choose formulas whatever the states are, or step with them: where one changes, equations may jump."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.continuation.choices import Choices
from contin.continuation.problem import Problem, in_two_parameters
from contin.lowering.switching import switching_functions
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, div, postorder, symbols_in
from contin.model.kept import kept_with
from contin.model.kinds import JUMPING
from contin.model.model import Model
from contin.model.printing import to_text

Rows = Mapping[str, Array]


@dataclass(frozen=True)
class _Choice:
    text: str
    function: Expression
    stepwise: bool
    names: frozenset[str]


def choices_of(problem: Problem, z: Array) -> Choices:
    """See `Problem.choices`; of what is no model of formulas nothing is known."""
    model = problem.formulas
    known = kept_with(model, "choices", lambda: _choices(model)) if isinstance(model, Model) else ()
    states = frozenset(model.state_names) if isinstance(model, Model) else frozenset()
    nowhere: list[Rows] = [{}]
    points = _points(problem, tuple(model.state_names), z) if known and isinstance(model, Model) else nowhere
    found = [(one, point) for one in known for point in (points if one.names & states else nowhere)]
    if not found:
        return Choices.none(len(z))
    varied = _varied(problem, z)
    constants = {name: np.full(len(z), value) for name, value in problem.constants().items()}
    values = np.array([_along(one.function, constants | varied | dict(point), len(z)) for one, point in found]).T
    return Choices(
        tuple(one.text for one, _ in found), values, np.array([one.stepwise for one, _ in found]),
        np.array([_alone(problem, one.names, states) for one, _ in found]),
    )  # fmt: skip


def _choices(model: Model) -> tuple[_Choice, ...]:
    """Those that depend on parameters alone; of maps and algebraic equations also what steps with the states."""
    formulas = [*model.equations, *(condition.residual for condition in model.conditions)]
    parameters = frozenset(model.parameter_names)
    own = parameters | frozenset(model.state_names) if model.kind in ("map", "algebraic") else parameters
    found = []
    for function in switching_functions(formulas, parameters):
        found.append(_Choice(f"{to_text(function)} = 0", function, False, frozenset(symbols_in([function]))))
    for node in dict.fromkeys(n for n in postorder(formulas) if n.op in JUMPING):
        function = div(*node.args) if node.op == "mod" else node.args[0]
        found.append(_Choice(to_text(node), function, True, frozenset(symbols_in([function]))))
    return tuple(one for one in found if one.names and one.names <= (own if one.stepwise else parameters))


def _places(problem: Problem) -> dict[str, int]:
    """The varying parameters' places among the unknowns, from the end."""
    parameters = problem.parameters
    found = {parameters[0]: -1}
    if in_two_parameters(problem):
        size = max(index for index, _, _ in problem.walls) + 1  # the last unknown's is among them, or all count from it
        for (index, _, _), name in zip(problem.walls, reversed(parameters[: len(problem.walls)]), strict=True):
            found[name] = index - size if index >= 0 else index
    return found


def _varied(problem: Problem, z: Array) -> dict[str, Array]:
    rows = {name: np.asarray(problem.column(name, z)) for name in problem.free_names}
    return rows | {name: z[:, place] for name, place in _places(problem).items()}


def _points(problem: Problem, states: tuple[str, ...], z: Array) -> list[Rows]:
    """The states by name at each point of the cycles in rows z; none where these hold other unknowns."""
    unknowns = z.shape[1] - 1
    if in_two_parameters(problem) or problem.free_names or problem.kind == "locus" or unknowns % len(states):
        return []
    points = z[:, :-1].reshape(len(z), -1, len(states))
    return [dict(zip(states, points[:, k].T, strict=True)) for k in range(points.shape[1])]


def _alone(problem: Problem, names: frozenset[str], states: frozenset[str]) -> int:
    """The place of the one unknown that a function of these depends on; 0 where there are others."""
    places = _places(problem)
    varying = names & (places.keys() | states | set(problem.free_names))
    return places.get(next(iter(varying)), 0) if len(varying) == 1 else 0


def _along(function: Expression, rows: Rows, count: int) -> Array:
    """Its values at rows."""
    own = {name: rows[name] for name in symbols_in([function])}
    return np.array([evaluate_all([function], {n: float(v[k]) for n, v in own.items()})[0] for k in range(count)])
