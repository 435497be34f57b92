"""Pass: other coordinates for the states."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from contin.errors import InputError
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, add, mul, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Start, State, Symmetry
from contin.records import Record
from contin.symbolic.calculus.derivatives import sparse_jacobian
from contin.symbolic.calculus.shorter import shorter
from contin.symbolic.passes.formulas import read

SAMPLES: Final = 5
TRIES: Final = 60
TOLERANCE: Final = 1e-8


def change_coordinates(model: Model, states: Record, inverse: Record, periods: Record | None = None) -> Model:
    """The model in new states: `states` gives each in the old ones, `inverse` each old state in the new ones.

    With v = phi(u): v' = Dphi(u) f(u) at u = inverse(v); for a map, v -> phi(f(inverse(v))). Starts, values and
    observables are converted; symmetries are conjugated, g -> phi g inverse. `periods` names new states that are
    angles. That `inverse` undoes `states` is checked at random points near the default state.

    Raises
    ------
    InputError
        A formula has a mistake, or `inverse` is not the inverse.
    """
    old_names, parameters = list(model.state_names), list(model.parameter_names)
    new_names = list(states)
    _check_names(model, new_names, inverse)
    phi = [read(states[n], [*old_names, *parameters], f"coordinates: {n}") for n in new_names]
    back = {n: read(inverse[n], [*new_names, *parameters], f"coordinates: inverse of {n}") for n in old_names}
    mapping = {symbol(n): e for n, e in back.items()}
    _check(model, dict(zip(new_names, phi, strict=True)), back)

    def converted(formula: Expression) -> Expression:
        return shorter(substitute([formula], mapping)[0])

    angles = {n: read(v, parameters, f"coordinates: period of {n}") for n, v in (periods or {}).items()}

    def at(point: Mapping[Expression, Expression]) -> list[Expression]:
        return substitute(phi, point)

    defaults = {symbol(s.name): s.value for s in model.states}
    values = at(defaults)
    starts = tuple(
        Start(
            s.name,
            dict(zip(new_names, at({**defaults, **{symbol(n): e for n, e in s.states.items()}}), strict=True)),
            s.parameters,
        )
        for s in model.starts
    )

    def conjugated(s: Symmetry) -> Symmetry:
        images = {symbol(n): s.map.get(n, symbol(n)) for n in old_names}
        formulas = {n: converted(substitute([p], images)[0]) for n, p in zip(new_names, phi, strict=True)}
        return Symmetry(s.name, {n: e for n, e in formulas.items() if e is not symbol(n)})

    return model.replace(
        states=tuple(State(n, v, None, None, angles.get(n)) for n, v in zip(new_names, values, strict=True)),
        equations=tuple(converted(rate) for rate in _rates(model, phi)),
        functions={},
        definitions={},
        observables={n: converted(e) for n, e in model.observables.items() if n not in new_names},
        symmetries=tuple(s for s in map(conjugated, model.symmetries) if s.map),
        rotation={},
        starts=starts,
        averaging=None,
        limits=tuple(replace(limit, margin=converted(limit.margin)) for limit in model.limits),
        expect=(),
    )


def _rates(model: Model, phi: list[Expression]) -> list[Expression]:
    """Dphi f of a flow, phi(f) of a map, in the old states."""
    if model.kind == "map":
        images = dict(zip((symbol(n) for n in model.state_names), model.equations, strict=True))
        return [substitute([p], images)[0] for p in phi]
    rows: list[list[Expression]] = [[] for _ in phi]
    for (i, j), slope in sparse_jacobian(phi, list(model.state_names)).items():
        rows[i].append(mul(slope, model.equations[j]))
    return [add(*row) for row in rows]


def _check_names(model: Model, new_names: list[str], inverse: Record) -> None:
    """As many new states as old ones, none of them named like a parameter, and every old one given in them."""
    old_names = list(model.state_names)
    taken = sorted(set(new_names) & set(model.parameter_names))
    if taken:
        raise InputError(f"coordinates: {taken[0]} is a parameter; choose another name for the state")
    missing = [n for n in old_names if n not in inverse]
    if missing or len(new_names) != len(old_names):
        what = f"give `inverse` for {missing[0]}" if missing else f"{len(old_names)} states need as many new ones"
        raise InputError(f"coordinates: {what}")


def _check(model: Model, phi: Mapping[str, Expression], back: Mapping[str, Expression]) -> None:
    parameters = model.default_parameters()
    centre = dict(zip(model.state_names, model.start_point()[0], strict=True))
    chance = random.Random(0)
    done = 0
    for _ in range(TRIES):
        point = {n: v + chance.uniform(-0.3, 0.3) * (1 + abs(v)) for n, v in centre.items()}
        there = dict(zip(phi, evaluate_all(phi.values(), {**parameters, **point}), strict=True))
        again = dict(zip(back, evaluate_all(back.values(), {**parameters, **there}), strict=True))
        if not all(math.isfinite(v) for v in again.values()):
            continue
        for name, value in point.items():
            if abs(again[name] - value) > TOLERANCE * (1 + abs(value)):
                raise InputError(
                    f"coordinates: `inverse` does not undo `states`: {name} = {value:.6g} returns as {again[name]:.6g}"
                )
        done += 1
        if done == SAMPLES:
            return
    if not done:
        raise InputError("coordinates: the formulas are not finite near the default state")
