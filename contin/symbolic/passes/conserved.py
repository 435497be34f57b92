"""Pass: conserved totals become parameters, and one state of each is eliminated.

Along a line of states with the same totals f(x, p) = 0 has isolated solutions; in all states its Jacobian is singular
everywhere, and nothing can be continued. With C x = T and C = (C_r, C_e) the eliminated states are
x_e = C_e^-1 (T - C_r x_r). They are chosen by elimination with complete pivoting on |c_i x_i| at the model's default
start, so that no large number is subtracted from another one to give the small one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.errors import ContinError
from contin.model.any_model import AnyModel
from contin.model.evaluate import evaluate_all
from contin.model.expression import ZERO, Expression, add, div, mul, neg, sub, substitute, symbol
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.model.parts import Parameter, Start, Symmetry, Total
from contin.model.totals import total_lines
from contin.symbolic.passes.conserved_laws import Law, conserved_laws, total_of
from contin.symbolic.passes.holding import holds

SMALLEST: Final = 1e-6  # part of the largest |c x| that counts for a state that is zero at the start


def without_conserved(model: object) -> Any:
    """The model at fixed totals, made once: itself where it has none, declares `conserved: false` or is a function.

    Jumps (`events:`) change what the flow conserves, so that models with them are as they are.
    """
    if not isinstance(model, Model) or not model.conserved or model.totals or model.rotation or model.events:
        return model
    return kept_with(model, "without conserved totals", lambda: reduce_conserved(model))


def reduce_conserved(model: Model) -> Model:
    """The pass itself. The reduced model keeps the names of states and parameters; observables give the others."""
    laws = [law for law in conserved_laws(model) if not _turns(model, law)]
    return _reduced(model, laws) if 0 < len(laws) < len(model.states) else model


def conserved_notes(model: object) -> list[str]:
    """What a report says of the totals of a reduced model."""
    return total_lines(getattr(model, "totals", ()))


def with_named_totals(model: object, names: Iterable[str]) -> Any:
    """The model at fixed totals where one of these names is such a total; else the model as it is."""
    if not isinstance(model, Model) or all(name in model.parameter_names for name in names):
        return model
    reduced = without_conserved(model)
    return reduced if any(t.name in names for t in reduced.totals) else model


def starting_names(model: AnyModel) -> tuple[str, ...]:
    """States that a start may give, those that totals have eliminated too."""
    given: tuple[str, ...] | None = getattr(model, "starting_names", None)
    return tuple(model.state_names) if given is None else given


def _turns(model: Model, law: Law) -> bool:
    """True where an angle takes part: a sum of angles is no number."""
    return any(s.period is not None and s.name in law.coefficients for s in model.states)


def _reduced(model: Model, laws: Sequence[Law]) -> Model:
    pivots = _eliminated(model, laws)
    eliminated = [pivots[i] for i in range(len(laws))]
    names = _total_names(model, laws)
    defaults = {s.name: s.value for s in model.states}
    solved = _solved(laws, pivots, [symbol(n) for n in names])
    mapping = {symbol(n): e for n, e in solved.items()}
    totals = [
        Total(name, law.coefficients, next(s for s in model.states if s.name == gone), _note(law))
        for name, law, gone in zip(names, laws, eliminated, strict=True)
    ]
    parameters = [
        Parameter(t.name, total_of(law, defaults), description=f"conserved, of {', '.join(law.coefficients)}")
        for t, law in zip(totals, laws, strict=True)
    ]
    left = [k for k, s in enumerate(model.states) if s.name not in eliminated]

    def change(formulas: Mapping[str, Expression]) -> dict[str, Expression]:
        return dict(zip(formulas, substitute(formulas.values(), mapping), strict=True))

    result = model.replace(
        states=tuple(model.states[k] for k in left),
        parameters=(*model.parameters, *parameters),
        equations=tuple(substitute([model.equations[k] for k in left], mapping)),
        definitions=change(model.definitions),
        observables={**{n: solved[n] for n in model.state_names if n in solved}, **change(model.observables)},
        symmetries=(),
        starts=tuple(_start(s, laws, names, defaults, set(eliminated)) for s in model.starts),
        limits=tuple(replace(m, margin=substitute([m.margin], mapping)[0]) for m in model.limits),
        totals=tuple(totals),
    )
    kept = [_symmetry(s, eliminated, mapping) for s in model.symmetries]
    return result.replace(symmetries=tuple(s for s in kept if s.map and holds(result, s)))


def _note(law: Law) -> str:
    return "" if not law.error else f"at random states and parameters, with relative errors up to {law.error:.0e}"


def _start(start: Start, laws: Sequence[Law], names: Sequence[str], defaults: Mapping[str, Expression],
           gone: set[str]) -> Start:  # fmt: skip
    """A named start with the totals that belong to it."""
    values = {**defaults, **start.states}
    parameters = {n: total_of(law, values) for n, law in zip(names, laws, strict=True)}
    left = {n: v for n, v in start.states.items() if n not in gone}
    return Start(start.name, left, {**parameters, **start.parameters})


def _symmetry(s: Symmetry, eliminated: Sequence[str], mapping: Mapping[Expression, Expression]) -> Symmetry:
    images = {n: e for n, e in s.map.items() if n not in eliminated}
    changed = dict(zip(images, substitute(images.values(), mapping), strict=True))
    return Symmetry(s.name, {n: e for n, e in changed.items() if e is not symbol(n)})


def _total_names(model: Model, laws: Sequence[Law]) -> list[str]:
    """total_A of the first state A of each law that no other total is named after."""
    taken = {*model.state_names, *model.parameter_names, *model.definitions, *model.observables, *model.functions}
    names: list[str] = []
    for law in laws:
        free = [f"total_{s}" for s in model.state_names if s in law.coefficients]
        name = next((n for n in free if n not in taken), free[0])
        while name in taken:
            name += "_"
        taken.add(name)
        names.append(name)
    return names


def _eliminated(model: Model, laws: Sequence[Law]) -> dict[int, str]:
    """The state that each law, by its position, eliminates; in the order of the pivots."""
    try:
        u, p = model.start_point()
    except ContinError:  # the start is told to be no good where it is needed
        u, p = np.ones(len(model.states)), np.ones(len(model.parameters))
    values = dict(zip(model.parameter_names, p.tolist(), strict=True))
    table = np.zeros((len(laws), len(model.states)))
    for i, law in enumerate(laws):
        columns = [model.state_names.index(n) for n in law.coefficients]
        table[i, columns] = evaluate_all(law.coefficients.values(), values)
    largest = float(np.abs(u).max(initial=0.0)) or 1.0
    weights = table * np.maximum(np.abs(u), SMALLEST * largest)
    found: dict[int, str] = {}
    for _ in laws:
        weights[list(found)] = 0.0
        # the last of equals: networks list what is made last, and its equation is the longest
        ranks = {at: (float(abs(weights[at])) * (1.0 + 1e-9 * at[1]), -at[0]) for at in np.ndindex(weights.shape)}
        i, j = max(ranks, key=lambda at: ranks[at])
        found[i] = model.state_names[j]
        for k in range(len(laws)):
            if k not in found:
                weights[k] -= weights[k, j] / weights[i, j] * weights[i]
                weights[k, j] = 0.0
    return found


def _solved(laws: Sequence[Law], eliminated: Mapping[int, str], totals: Sequence[Expression]) -> dict[str, Expression]:
    """Each eliminated state in the others and the totals, by Gauss-Jordan elimination."""
    rows = [dict(law.coefficients) for law in laws]
    sides = list(totals)
    for i, gone in eliminated.items():
        pivot = rows[i][gone]
        rows[i] = {n: div(c, pivot) for n, c in rows[i].items()}
        sides[i] = div(sides[i], pivot)
        for k in range(len(rows)):
            factor = rows[k].get(gone, ZERO)
            if k == i or factor is ZERO:
                continue
            for n, c in rows[i].items():
                rows[k][n] = sub(rows[k].get(n, ZERO), mul(factor, c))
            rows[k] = {n: c for n, c in rows[k].items() if c is not ZERO and n != gone}
            sides[k] = sub(sides[k], mul(factor, sides[i]))
    return {
        gone: add(sides[i], *(neg(mul(c, symbol(n))) for n, c in rows[i].items() if n != gone))
        for i, gone in eliminated.items()
    }
