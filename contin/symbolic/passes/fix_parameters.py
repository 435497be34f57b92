"""Pass: parameters become numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import Expression, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Start, State
from contin.records import Record
from contin.symbolic.passes.formulas import read


def fix_parameters(model: Model, parameters: Record) -> Model:
    """The model with these parameters replaced by numbers or by formulas in the remaining ones.

    Starts that set a fixed parameter lose that setting. Raises `InputError` for a name that is no parameter, and where
    the small parameter of an averaging section is to be fixed.
    """
    kept = [p for p in model.parameters if p.name not in parameters]
    for name in parameters:
        if name not in model.parameter_names:
            advice = closest(name, model.parameter_names) or f"there are {', '.join(model.parameter_names) or 'none'}"
            raise InputError(f"fix: {model.name} has no parameter {name!r}: {advice}")
    if model.averaging is not None and model.averaging.small in parameters:
        raise InputError(f"fix: {model.averaging.small} is the small parameter; average first")
    names = [p.name for p in kept]
    mapping = {symbol(n): read(v, names, f"fix: {n}") for n, v in parameters.items()}
    return mapped(model.replace(parameters=tuple(kept)), lambda e: substitute([e], mapping)[0], set(parameters))


def mapped(model: Model, change: Callable[[Expression], Expression], dropped: set[str]) -> Model:
    """Every formula of the model changed alike; `dropped` parameters are no longer set by starts."""

    def states_of(state: State) -> State:
        period = None if state.period is None else change(state.period)
        scale = None if state.scale is None else change(state.scale)
        return replace(state, value=change(state.value), period=period, scale=scale)

    def start_of(start: Start) -> Start:
        parameters = {n: change(e) for n, e in start.parameters.items() if n not in dropped}
        return Start(start.name, {n: change(e) for n, e in start.states.items()}, parameters)

    return model.replace(
        states=tuple(states_of(s) for s in model.states),
        parameters=tuple(
            replace(
                p,
                value=change(p.value),
                range=None if p.range is None else (change(p.range[0]), change(p.range[1])),
                scale=None if p.scale is None else change(p.scale),
            )
            for p in model.parameters
        ),
        equations=tuple(change(e) for e in model.equations),
        functions={},  # they are inserted in the formulas, and their texts may name what is gone
        definitions={n: change(e) for n, e in model.definitions.items()},
        observables={n: change(e) for n, e in model.observables.items()},
        symmetries=tuple(replace(s, map={n: change(e) for n, e in s.map.items()}) for s in model.symmetries),
        rotation={n: change(e) for n, e in model.rotation.items()},
        starts=tuple(start_of(s) for s in model.starts),
        forcing=None if model.forcing is None else replace(model.forcing, period=change(model.forcing.period)),
        mass={row: {n: change(e) for n, e in entries.items()} for row, entries in model.mass.items()},
        limits=tuple(replace(limit, margin=change(limit.margin)) for limit in model.limits),
        expect=(),
    )
