"""The parts of an SBML model put together as a model document."""

from __future__ import annotations

import math
from pathlib import Path

from contin.errors import InputError
from contin.exchange.sbml import mathml
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.events import events_of
from contin.exchange.sbml.initial import Initial
from contin.exchange.sbml.reactions import changes, conversion, rates_of
from contin.exchange.sbml.roles import EVENTS, FIXED, RATE, REACTIONS, RULE
from contin.exchange.sbml.symbols import Symbol, Symbols, symbols_of
from contin.exchange.sbml.units import unit_of
from contin.model.evaluate import evaluate
from contin.model.expression import symbols_in
from contin.model.parser import parse
from contin.records import Fields


class Assembly:
    """Collects states, parameters, definitions and observables of one model."""

    def __init__(self, model: Element, path: Path, notes: list[str]) -> None:
        self.model, self.where = model, str(path)
        self.title = model.getName() or None
        self.functions = {f.getIdAttribute() or f.getId(): f for f in model.getListOfFunctionDefinitions()}
        self.symbols: Symbols = symbols_of(model, notes)
        self.rates, self.local = rates_of(model, self.symbols, self.functions, self.where)
        self.initial = Initial(self.symbols, self.functions, self.rates, self.where)
        self.names = {**{i: s.name for i, s in self.symbols.of.items()}, **self.symbols.reactions}
        self.states: Fields = {}
        self.equations: dict[str, str] = {}
        self.parameters: Fields = {}
        self.definitions: dict[str, str] = {}
        self.amounts: dict[str, str] = {}  # identifier of a species -> formula of its amount
        self.values: dict[str, float] = {}  # of parameters
        self.open: list[str] = []  # those that are being worked out

    def document(self) -> Fields:
        """The mapping that a model file holds."""
        for name, value in self.local.items():
            self._fixed(name, value, None)
        for reaction, rate in self.rates.items():
            if reaction in self.symbols.reactions:
                self.definitions[self.symbols.reactions[reaction]] = rate(self.names, "t")
        named = {r: self.symbols.reactions.get(r) or f"({rate(self.names, 't')})" for r, rate in self.rates.items()}
        self.terms = changes(self.model, self.symbols, self.functions, self.names, named, self.where)
        for symbol in self._in_order():
            self._place(symbol)
        identifier = self.model.getIdAttribute() or self.model.getId()
        observables, labels = self._observed()
        found = {
            "name": identifier or Path(self.where).stem,
            "title": self.title,
            "states": self.states,
            "parameters": self.parameters,
            "definitions": self.definitions,
            "equations": self.equations,
            "observables": observables,
            "events": events_of(self),
            "labels": labels,
        }
        return {key: value for key, value in found.items() if value or key in ("states", "equations")}

    def _in_order(self) -> list[Symbol]:
        """Compartments first: species are divided by their sizes."""
        order = ("compartment", "parameter", "reference", "species")
        return sorted(self.symbols.of.values(), key=lambda s: order.index(s.kind))

    def _place(self, symbol: Symbol) -> None:
        if symbol.role == RULE:
            self.definitions[symbol.name] = self._math(symbol)
        elif symbol.role == RATE:
            self._state(symbol.name, self.initial.value(symbol.id), self._math(symbol), symbol)
        elif symbol.role == REACTIONS or (symbol.role == EVENTS and symbol.kind == "species"):
            self._reacting(symbol)
        elif symbol.role == EVENTS:
            self._state(symbol.name, self.initial.value(symbol.id), "0", symbol)
        elif self.initial.varies(symbol):
            amount = self.symbols.names.take(f"amount_{symbol.id}")
            size = self._size(symbol)
            self._fixed(amount, f"{self.initial.value(symbol.id)}*{self.initial[self._compartment(symbol)]}", symbol)
            self.definitions[symbol.name] = f"{amount}/{size}"
            self.amounts[symbol.id] = amount
        else:
            self._fixed(symbol.name, self.initial.value(symbol.id), symbol)

    def _math(self, symbol: Symbol) -> str:
        scope = mathml.Scope(self.names, self.functions, where=f"{self.where}, rule of {symbol.id}")
        return mathml.number(symbol.math, scope)

    def _reacting(self, symbol: Symbol) -> None:
        """A species that reactions change: its amount or its concentration is the state."""
        terms = self.terms.get(symbol.id, [])
        rate = " + ".join(terms) or "0"
        factor = conversion(self.model, symbol.element, self.symbols)
        rate = f"{factor}*({rate})" if factor else rate
        start = self.initial.value(symbol.id)
        if self.symbols.is_amount(symbol.element):
            self._state(symbol.name, start, rate, symbol)
        elif self.symbols.size_is_fixed(symbol.element):
            self._state(symbol.name, start, f"({rate})/{self._size(symbol)}", symbol)
        else:
            amount = self.symbols.names.take(f"amount_{symbol.id}")
            self._state(amount, f"{start}*{self.initial[self._compartment(symbol)]}", rate, symbol)
            self.definitions[symbol.name] = f"{amount}/{self._size(symbol)}"
            self.amounts[symbol.id] = amount

    def _compartment(self, symbol: Symbol) -> str:
        return str(symbol.element.getCompartment())

    def _size(self, symbol: Symbol) -> str:
        return self.names[self._compartment(symbol)]

    def _state(self, name: str, start: str, rate: str, symbol: Symbol) -> None:
        self.states[name] = self._entry(start, symbol)
        self.equations[name] = rate

    def _fixed(self, name: str, value: str, symbol: Symbol | None) -> None:
        """A parameter; a definition where its value is not finite."""
        if math.isfinite(self.number_of(value)):
            self.parameters[name] = self._entry(value, symbol)
        else:
            self.definitions[name] = value

    def _entry(self, value: str, symbol: Symbol | None) -> Fields | str:
        unit = None if symbol is None or self._is_concentration(symbol) else unit_of(self.model, symbol.element)
        title = None if symbol is None else symbol.element.getName()
        more = {"unit": unit, "description": title if title and title != symbol.id else None} if symbol else {}
        more = {key: text for key, text in more.items() if text}
        return {"value": value, **more} if more else value

    def _is_concentration(self, symbol: Symbol) -> bool:
        return symbol.kind == "species" and symbol.id not in self.amounts and not self.symbols.is_amount(symbol.element)

    def number_of(self, formula: str) -> float:
        """The value of a formula in fixed symbols."""
        node = parse(formula)
        known = {name: self._value_of(name) for name in symbols_in([node])}
        return float(evaluate(node, known))

    def _value_of(self, name: str) -> float:
        if name in self.open:
            circle = " -> ".join([*self.open[self.open.index(name) :], name])
            raise InputError(f"{self.where}: initial values are defined in a circle: {circle}")
        if name not in self.values:
            self.open.append(name)
            symbol = next((s for s in self.symbols.of.values() if s.name == name and s.role == FIXED), None)
            text = self.local[name] if symbol is None else self.initial.value(symbol.id)
            self.values[name] = self.number_of(text)
            self.open.pop()
        return self.values[name]

    def _observed(self) -> tuple[dict[str, str], dict[str, str]]:
        """Observables, and how tables call those whose identifiers the formulas cannot use."""
        observables, labels = {}, {}
        for identifier, name in self.names.items():
            if name not in self.states and (name in self.parameters or name in self.definitions):
                observables[name] = name
            if name != identifier:
                labels[name] = identifier
        for symbol in self.symbols.of.values():
            if symbol.kind == "species":
                observables.update(self._amount_and_concentration(symbol))
        return observables, labels

    def _amount_and_concentration(self, symbol: Symbol) -> dict[str, str]:
        size, name = self._size(symbol), symbol.name
        is_amount = self.symbols.is_amount(symbol.element)
        amount = self.amounts.get(symbol.id) or (name if is_amount else f"{name}*{size}")
        found = {"amount": amount}
        if not self.symbols.without_extent(self._compartment(symbol)):
            found["concentration"] = f"{name}/{size}" if is_amount else name
        named = {}
        for what, formula in found.items():
            wanted = f"{what}_{symbol.id}"
            if formula == wanted and wanted not in self.parameters:
                continue  # the state itself
            if wanted not in self.names:
                named[wanted if formula == wanted else self.symbols.names.take(wanted)] = formula
        return named
