"""Pass: other units for time and states."""

from __future__ import annotations

from dataclasses import replace

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import ONE, Expression, div, mul, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Start
from contin.records import Record
from contin.symbolic.passes.formulas import read


def scale(model: Model, time: object = 1, states: Record | None = None) -> Model:
    """The model in units `time` of time and `states` of the states: t = time * new t, x = unit * new x.

    Units are numbers or formulas in the parameters, and must not be zero. Names stay; values, starts, observables and
    symmetries are converted, so that observables keep their values. A map has no time to scale.
    """
    units = {name: read(v, model.parameter_names, f"scale: {name}") for name, v in (states or {}).items()}
    for name in units:
        if name not in model.state_names:
            advice = closest(name, model.state_names) or f"there are {', '.join(model.state_names)}"
            raise InputError(f"scale: {model.name} has no state {name!r}: {advice}")
    clock = read(time, model.parameter_names, "scale: time")
    if clock is not ONE and (model.kind == "map" or model.forcing is not None):
        raise InputError("scale: a map or a forced model has no time of its own to scale")
    old = {symbol(name): mul(unit, symbol(name)) for name, unit in units.items()}

    def unit_of(name: str) -> Expression:
        return units.get(name, ONE)

    def converted(formula: Expression) -> Expression:
        return substitute([formula], old)[0]

    factor = ONE if model.kind == "map" else clock
    pairs = zip(model.state_names, model.equations, strict=True)
    return model.replace(
        states=tuple(
            replace(
                s,
                value=div(s.value, unit_of(s.name)),
                period=None if s.period is None else div(s.period, unit_of(s.name)),
                scale=None if s.scale is None else div(s.scale, unit_of(s.name)),
                unit=None if s.name in units else s.unit,
            )
            for s in model.states
        ),
        equations=tuple(div(mul(factor, converted(e)), unit_of(name)) for name, e in pairs),
        definitions={n: converted(e) for n, e in model.definitions.items()},
        observables={n: converted(e) for n, e in model.observables.items()},
        symmetries=tuple(
            replace(s, map={n: div(converted(e), unit_of(n)) for n, e in s.map.items()}) for s in model.symmetries
        ),
        rotation={n: div(converted(e), unit_of(n)) for n, e in model.rotation.items()},
        starts=tuple(
            Start(s.name, {n: div(e, unit_of(n)) for n, e in s.states.items()}, s.parameters) for s in model.starts
        ),
        mass={
            row: {n: div(mul(entry, unit_of(n)), unit_of(row)) for n, entry in entries.items()}
            for row, entries in model.mass.items()
        },
        limits=tuple(replace(limit, margin=converted(limit.margin)) for limit in model.limits),
        expect=(),
    )
