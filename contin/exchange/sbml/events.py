"""SBML events without delay -> `events:` of a model: the trigger as a function that crosses zero upwards.

a > b and a >= b become a - b, `and` the smaller of two, `or` the larger, `not` the negative: the trigger is true where
the function is positive, and becomes true where it crosses zero. What has no equal is refused by name: delays,
priorities, == and xor in triggers, an event that happens at time 0; and in a model of several events those that depend
on others of the same time (not persistent, or with values from the time of execution).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Final, Protocol

import libsbml

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.sbml import mathml
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.initial import Initial
from contin.exchange.sbml.roles import RATE
from contin.exchange.sbml.symbols import Symbols
from contin.model.expression import symbols_in
from contin.model.parser import parse
from contin.records import Fields

_UP: Final = frozenset({libsbml.AST_RELATIONAL_GT, libsbml.AST_RELATIONAL_GEQ})
_DOWN: Final = frozenset({libsbml.AST_RELATIONAL_LT, libsbml.AST_RELATIONAL_LEQ})
_STRICT: Final = frozenset({libsbml.AST_RELATIONAL_GT, libsbml.AST_RELATIONAL_LT})


class Assembled(Protocol):
    """What events need of the model that is put together."""

    model: Element
    where: str
    names: dict[str, str]
    functions: dict[str, Element]
    parameters: Fields
    amounts: dict[str, str]
    symbols: Symbols
    initial: Initial

    def number_of(self, formula: str) -> float:
        """The value of a formula in fixed symbols."""


def check_events(model: Element, path: object) -> None:
    """Raises UnsupportedError for events with what has no equal here."""
    several = model.getNumEvents() > 1
    for event in model.getListOfEvents():
        trigger = event.getTrigger()
        for what, has in (
            ("a <delay> of", event.isSetDelay() and event.getDelay().isSetMath()),
            ("a <priority> of", event.isSetPriority()),
            ("no formula in the <trigger> of", trigger is None or not trigger.isSetMath()),
            ("persistent='false' beside others in", several and trigger is not None and not trigger.getPersistent()),
            ("useValuesFromTriggerTime='false' beside others in", several and not event.getUseValuesFromTriggerTime()),
        ):  # fmt: skip
            if has:
                where = f"{path}: line {event.getLine()}"
                raise UnsupportedError(f"{where}: {what} <event>{_named(event)} is not supported")


def _named(event: Element) -> str:
    name = event.getIdAttribute() or event.getName()
    return f" {name!r}" if name else ""


def events_of(assembly: Assembled) -> list[Fields]:
    """The entries of `events:`."""
    found = []
    for event in assembly.model.getListOfEvents():
        where = f"{assembly.where}, line {event.getLine()}, event{_named(event)}"
        scope = mathml.Scope(assembly.names, assembly.functions, where=where)
        math = event.getTrigger().getMath()
        sets = dict(_assignments(assembly, event, scope))
        when = height(math, scope)
        if when is None or not sets:
            continue  # a trigger that never changes, or nothing to do
        _refuse_at_zero(assembly, event, where)
        if set(symbols_in([parse(when)])) <= set(assembly.parameters):
            continue
        found.append({"when": when, "direction": "up", "set": sets})
    return found


def _assignments(assembly: Assembled, event: Element, scope: mathml.Scope) -> Iterator[tuple[str, str]]:
    """State -> its formula."""
    given = {
        a.getVariable(): mathml.number(a.getMath(), scope) for a in event.getListOfEventAssignments() if a.isSetMath()
    }
    for identifier, formula in given.items():
        amount = assembly.amounts.get(identifier)
        if amount is not None:  # a concentration is assigned before its compartment's size is, and the amount stays
            yield amount, f"({formula})*{assembly.names[_compartment(assembly, identifier)]}"
        elif not _is_rated(assembly, identifier, given):
            yield assembly.names[identifier], formula
    for identifier, symbol in assembly.symbols.of.items():
        if _is_rated(assembly, identifier, given):
            size = _compartment(assembly, identifier)
            before = f"({given.get(identifier, symbol.name)})*{assembly.names[size]}"
            yield symbol.name, f"{before}/({given[size]})"


def _compartment(assembly: Assembled, species: str) -> str:
    return str(assembly.symbols.of[species].element.getCompartment())


def _is_rated(assembly: Assembled, identifier: str, given: Mapping[str, str]) -> bool:
    """True for a concentration that is a state, with a rule for its rate, in a compartment whose size is assigned."""
    symbol = assembly.symbols.of[identifier]
    if symbol.kind != "species" or symbol.role != RATE or assembly.symbols.is_amount(symbol.element):
        return False
    return _compartment(assembly, identifier) in given


def _refuse_at_zero(assembly: Assembled, event: Element, where: str) -> None:
    """Raises UnsupportedError for an event that happens at time 0, or may do so."""
    math = event.getTrigger().getMath()
    scope = mathml.Scope(assembly.initial, assembly.functions, "0", where)
    formula = height(math, scope)
    begins = assembly.number_of(formula) if formula is not None else -1.0
    fires = begins >= 0.0 and not event.getTrigger().getInitialValue()
    if fires or (begins == 0.0 and _is_strict(math)):
        raise UnsupportedError(f"{where}: it happens at time 0, which is not supported")


def _is_strict(node: Element) -> bool:
    return node.getType() in _STRICT or any(_is_strict(node.getChild(k)) for k in range(node.getNumChildren()))


def height(node: Element, scope: mathml.Scope, depth: int = 0) -> str | None:
    """A formula that is positive where the condition holds; None for one that is constant."""
    if depth > mathml.MAX_DEPTH:
        raise InputError(f"{scope.where}: formulas are nested deeper than {mathml.MAX_DEPTH} levels")
    kind = node.getType()
    children = [node.getChild(k) for k in range(node.getNumChildren())]
    if kind in (libsbml.AST_CONSTANT_TRUE, libsbml.AST_CONSTANT_FALSE):
        return None
    if kind in _UP | _DOWN and len(children) > 1:
        sides = [mathml.number(child, scope) for child in children]
        pairs = pairwise(sides)
        return _extreme("min", [f"(({a}) - ({b}))" if kind in _UP else f"(({b}) - ({a}))" for a, b in pairs])
    if kind in (libsbml.AST_LOGICAL_AND, libsbml.AST_LOGICAL_OR) and children:
        parts = [height(child, scope, depth + 1) for child in children]
        if None not in parts:
            return _extreme("min" if kind == libsbml.AST_LOGICAL_AND else "max", [p for p in parts if p is not None])
    if kind == libsbml.AST_LOGICAL_NOT and children:
        inner = height(children[0], scope, depth + 1)
        return None if inner is None else f"(-{inner})"
    raise UnsupportedError(f"{scope.where}: only <, <=, >, >=, and, or, not are supported in a <trigger>")


def _extreme(name: str, parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{name}({', '.join(parts)})"
