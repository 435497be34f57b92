"""Pass: many equal systems joined to each other, with the permutations that keep the whole as symmetries."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Final

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import ZERO, Expression, add, substitute, symbol
from contin.model.model import Model
from contin.model.parts import TIME, Averaging, Event, Oscillator, Parameter, Start, State, Symmetry
from contin.records import Record
from contin.symbolic.passes.formulas import read
from contin.symbolic.passes.holding import holds

SHAPES: Final = ("all", "ring", "chain")
ENDS: Final = ("free", "fixed")
MOST: Final = 64
OTHER: Final = "_other"
Permutation = Callable[[int], int]


def array(
    model: Model,
    count: int,
    join: Record,
    shape: str = "all",
    ends: str = "free",
    parameters: Record | None = None,
) -> Model:
    """`count` copies of a flow, joined.

    States x become x1 .. xN. For every neighbour, `join` = {state: formula} adds the formula to the state's equation;
    there x is the own state, and x_other the neighbour's.

    Parameters
    ----------
    shape : who are neighbours: 'all', 'ring' or 'chain'.
    ends : of a chain: 'free' (one neighbour less) or 'fixed' (the missing neighbour rests at 0).
    parameters : {name: value} that `join` uses beside those of the model.

    Symmetries: permutations that generate all (exchange12, exchange23, ...; rotate and reflect; reflect), where the
    equations have them, and those of one copy applied to all. Named starts give all copies the same state.
    """
    _check(model, count, shape, ends)
    added = {n: read(v, model.parameter_names, f"array: parameters: {n}") for n, v in (parameters or {}).items()}
    formulas = _joining(model, join, added)
    taken = {*model.parameter_names, *added}
    for name in (f"{n}{i + 1}" for n in model.state_names for i in range(count)):
        if name in taken:
            raise InputError(f"array: the copies' state {name} is named like a parameter; rename the parameter")
    copies = [_Copy(model, i) for i in range(count)]
    equations = []
    for i, copy in enumerate(copies):
        for name, rate in model.equation_map.items():
            terms = [copy.of(rate)]
            if name in formulas:
                terms += [copy.of(formulas[name], j) for j in _neighbours(i, count, shape, ends)]
            equations.append(add(*terms))
    result = model.replace(
        title=f"{model.title or model.name}: {count} joined",
        states=tuple(s for copy in copies for s in copy.states()),
        parameters=(*model.parameters, *(Parameter(n, e) for n, e in added.items())),
        equations=tuple(equations),
        functions={},
        definitions={},
        observables={f"{n}{c.i + 1}": c.of(e) for c in copies for n, e in model.observables.items()},
        labels={},
        symmetries=(),
        rotation={},
        starts=tuple(_start(s, copies) for s in model.starts),
        averaging=_averaging(model.averaging, count),
        events=tuple(c.event(e) for c in copies for e in model.events),
        limits=tuple(replace(lim, margin=c.of(lim.margin)) for c in copies for lim in model.limits),
        expect=(),
    )
    candidates = [*_permutations(model, count, shape), *(_everywhere(s, copies) for s in model.symmetries)]
    return result.replace(symmetries=tuple(s for s in candidates if holds(result, s)))


def _joining(model: Model, join: Record, added: Iterable[str]) -> dict[str, Expression]:
    """What each state's equation gets for every neighbour."""
    names = [*model.state_names, *(n + OTHER for n in model.state_names)]
    known = [*names, *model.parameter_names, *added, *([TIME] if model.forcing is not None else [])]
    for state in join:
        if state not in model.state_names:
            advice = closest(state, model.state_names) or f"there are {', '.join(model.state_names)}"
            raise InputError(f"array: join: {state} is not a state: {advice}")
    return {n: read(v, known, f"array: join: {n}") for n, v in join.items()}


def _check(model: Model, count: int, shape: str, ends: str) -> None:
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST:
        raise InputError(f"array: count must be a whole number from 2 to {MOST}; got {count!r}")
    for key, value, allowed in (("shape", shape, SHAPES), ("ends", ends, ENDS)):
        if value not in allowed:
            raise InputError(f"array: {key} must be {' or '.join(allowed)}; got {value!r}")
    if model.kind != "flow" or model.mass or model.totals:
        raise InputError(f"array: {model.name} must be a flow without `mass` and reduced totals")


def _neighbours(i: int, count: int, shape: str, ends: str) -> Iterable[int | None]:
    """Those of copy i; None for a wall."""
    if shape == "all":
        return [j for j in range(count) if j != i]
    if shape == "ring":
        return sorted({(i - 1) % count, (i + 1) % count} - {i})
    sides = [j if 0 <= j < count else None for j in (i - 1, i + 1)]
    return sides if ends == "fixed" else [j for j in sides if j is not None]


class _Copy:
    def __init__(self, model: Model, i: int) -> None:
        self.model, self.i = model, i
        self.own = {symbol(n): symbol(f"{n}{i + 1}") for n in model.state_names}

    def of(self, formula: Expression, neighbour: int | None = None) -> Expression:
        """The formula in the states of this copy, and of the neighbour's (None: at rest)."""
        mapping: dict[Expression, Expression] = dict(self.own)
        for name in self.model.state_names:
            mapping[symbol(name + OTHER)] = ZERO if neighbour is None else symbol(f"{name}{neighbour + 1}")
        return substitute([formula], mapping)[0]

    def states(self) -> list[State]:
        return [replace(s, name=f"{s.name}{self.i + 1}") for s in self.model.states]

    def event(self, event: Event) -> Event:
        jumps = {f"{n}{self.i + 1}": self.of(e) for n, e in event.jumps.items()}
        return Event(self.of(event.when), event.direction, jumps)


def _start(start: Start, copies: Iterable[_Copy]) -> Start:
    states = {f"{n}{c.i + 1}": e for c in copies for n, e in start.states.items()}
    return Start(start.name, states, start.parameters)


def _everywhere(symmetry: Symmetry, copies: Iterable[_Copy]) -> Symmetry:
    return Symmetry(symmetry.name, {f"{n}{c.i + 1}": c.of(e) for c in copies for n, e in symmetry.map.items()})


def _averaging(item: Averaging | None, count: int) -> Averaging | None:
    if item is None:
        return None
    copies = range(1, count + 1)
    return replace(
        item,
        oscillators=tuple(
            Oscillator(f"{o.position}{i}", f"{o.velocity}{i}", o.harmonic) for i in copies for o in item.oscillators
        ),
        rotators=tuple(replace(r, phase=f"{r.phase}{i}") for i in copies for r in item.rotators),
        slow=tuple(f"{n}{i}" for i in copies for n in item.slow),
        slaved=tuple(f"{n}{i}" for i in copies for n in item.slaved),
    )


def _permutations(model: Model, count: int, shape: str) -> list[Symmetry]:
    moves: Mapping[str, Permutation]
    if shape == "all" or count == 2:
        if count == 2:
            moves = {"exchange": lambda i: 1 - i}
        else:
            moves = {f"exchange{a + 1}{b + 1}": _swap(a, b) for a, b in pairwise(range(count))}
    else:
        moves = {"reflect": lambda i: count - 1 - i}
        if shape == "ring":
            moves = {"rotate": lambda i: (i + 1) % count, **moves}
    return [_permuted(model, count, name, move) for name, move in moves.items()]


def _swap(a: int, b: int) -> Permutation:
    return lambda i: {a: b, b: a}.get(i, i)


def _permuted(model: Model, count: int, name: str, move: Permutation) -> Symmetry:
    images = {
        f"{n}{i + 1}": symbol(f"{n}{move(i) + 1}") for i in range(count) for n in model.state_names if move(i) != i
    }
    return Symmetry(name, images)
