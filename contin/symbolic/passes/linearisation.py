"""Pass: the linearisation at a solution."""

from __future__ import annotations

from contin.model.expression import ZERO, Expression, add, mul, number, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Start, State
from contin.model.starts import start_from_mapping
from contin.records import Record
from contin.symbolic.calculus.derivatives import sparse_jacobian


def linearise(model: Model, at: str | Record | None = None) -> Model:
    """v' = Df(u*, p) v (a map: v -> Df(u*, p) v) at the point `at`: a named start, a mapping of states, or the default.

    The states keep their names and mean deviations from u*, whose formulas in the parameters are inserted: the model
    is linear for all parameters, and is the linearisation at a solution wherever `at` is one.
    """
    start = _start(model, at)
    point = {symbol(s.name): start.states.get(s.name, s.value) for s in model.states}
    rows: list[list[Expression]] = [[] for _ in model.states]
    for (i, j), entry in sparse_jacobian(model.equations, model.state_names).items():
        rows[i].append(mul(substitute([entry], point)[0], symbol(model.state_names[j])))
    return model.replace(
        states=tuple(State(s.name, ZERO, s.unit, f"deviation of {s.name}") for s in model.states),
        equations=tuple(add(*row) if row else number(0) for row in rows),
        functions={},
        definitions={},
        observables={},
        symmetries=(),
        rotation={},
        starts=(),
        averaging=None,
        limits=(),  # the equations hold where they were linearised
        expect=(),
        title=f"{model.title or model.name}, linearised",
    )


def _start(model: Model, at: str | Record | None) -> Start:
    if at is None:
        return Start("", {})
    if isinstance(at, str):
        return model.start(at)

    return start_from_mapping(model, at)
