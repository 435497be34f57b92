"""Functions and definitions: worked out in the order of their dependencies, inserted where they are used."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Final

from contin.errors import ExpressionError
from contin.model.advice import closest
from contin.model.expression import Expression, is_condition, mask_of, number, substitute, symbol, symbols_in
from contin.model.lexer import canonical_name, is_name, tokenize
from contin.model.operators import as_written
from contin.model.order import CircleError, dependency_order
from contin.model.parser import Operand, parse_operand
from contin.model.schema import shown
from contin.model.scope import Budget, Function, Scope, placeholders
from contin.model.source import Path, Problems, Span
from contin.model.symbol_masks import crowd
from contin.model.templates import Templates
from contin.records import Json, Record

MANY: Final = 100  # symbols from which formulas are likely to be written alike
HEADING = re.compile(r"\s*([^\W\d]\w*)\s*\(([^()]*)\)\s*")


class Formulas:
    """Reads formulas of one model: remembers the functions and definitions, and notes mistakes in `problems`."""

    def __init__(self, problems: Problems, symbols: list[str], unavailable: Mapping[str, str]) -> None:
        self.problems = problems
        self.functions: dict[str, Function] = {}
        self.definitions: dict[str, Expression] = {}
        self.conditions: set[str] = set()
        self.budget = Budget()
        self._numbers: dict[tuple[type, str], Operand] = {}
        crowd(symbols)
        self.names = {name: symbol(name) for name in symbols}  # with the definitions, as they become known
        self.templates: Templates | None = None
        self.unavailable = unavailable

    def expect_many(self, states: Sequence[str]) -> None:
        """Formulas of many states are likely to be written alike."""
        if len(states) > MANY:
            mask = mask_of(states)
            self.templates = Templates({name: symbol(name) for name in states}, lambda name: self._brings(name, mask))

    def _brings(self, name: str, mask: int) -> bool:
        function = self.functions.get(name)
        node = self.definitions.get(name) if function is None else function.body
        return node is not None and bool(node.mask & mask)

    @property
    def scope(self) -> Scope:
        """What equations and observables may use."""
        return Scope(self.names, self.functions, self.conditions, self.unavailable, self.budget)

    def scope_of(self, names: list[str], hidden: Mapping[str, str]) -> Scope:
        """The scope in which only `names`, and definitions made of them alone, mean something."""
        allowed = {name: symbol(name) for name in names}
        known = mask_of(names)
        usable = {n: e for n, e in self.definitions.items() if e.mask | known == known}
        reasons = {n: f"{n} depends on states, which have no value here" for n in self.definitions if n not in usable}
        table = {**usable, **allowed}
        return Scope(table, self.functions, self.conditions, {**reasons, **hidden}, self.budget)

    def read(self, value: object, path: Path, scope: Scope) -> Expression:
        """One formula whose value is a number; after a mistake, the number 1."""
        operand = self.read_operand(value, path, scope)
        if operand.condition:
            self._note(path, value, "a condition is not a number; write, for example, 1 if x > 0 else 0", 0)
            return number(1)
        return operand.node

    def by_name(
        self, data: Record, names: Sequence[str], what: str, path: Path, scope: Scope, problems: Problems | None = None
    ) -> dict[str, Expression]:
        """The formula of each name; mistakes in a key or in the kind of a value go to `problems` (default: its own).

        what : what the names are of, in words.
        """
        found, allowed, noted = {}, set(names), problems or self.problems
        for key, value in data.items():
            name = canonical_name(key)
            if name not in allowed:
                advice = closest(name, names) or f"there are {', '.join(names) or 'none'}"
                noted.add((*path, key), f"not a {what}: {advice}", key=True)
            elif isinstance(value, bool | dict | list) or value is None:
                noted.add((*path, key), f"expected a number or a formula, got {shown(value)}")
            else:
                found[name] = self.read(value, (*path, key), scope)
        return found

    def read_operand(self, value: object, path: Path, scope: Scope) -> Operand:
        """One formula, a number or a condition."""
        if isinstance(value, Expression):
            return self._expression(value, path, scope)
        if not isinstance(value, str):
            return self._number(value)
        try:
            if self.templates is not None and scope.names is self.names:
                return self.templates.read(value, lambda: parse_operand(value, scope))
            return parse_operand(value, scope)
        except ExpressionError as error:
            self._note(path, value, str(error), error.position)
            return Operand(number(1), False, 0)

    def _number(self, value: Json) -> Operand:
        key = type(value), repr(value)  # -0.0 is not 0.0
        known = self._numbers.get(key)
        if known is None:
            known = self._numbers[key] = Operand(number(value), False, 0)
        return known

    def _note(self, path: Path, value: object, message: str, position: int) -> None:
        text = value if isinstance(value, str) else None
        end = position + 1
        if text is not None:
            word = re.compile(r"\w+").match(text, position)
            end = word.end() if word else end
        self.problems.add(path, message, value=text, span=Span(position, end))

    def _expression(self, value: Expression, path: Path, scope: Scope) -> Operand:
        names = scope.names or {}
        used = {s: names.get(s) for s in symbols_in([value])}
        for name, node in used.items():
            if node is None:
                self.problems.add(path, scope.unavailable.get(name, f"unknown name {name!r} in an expression"))
                return Operand(number(1), False, 0)
        nodes = {symbol(name): node for name, node in used.items() if node is not None}
        return Operand(substitute([as_written(value)], nodes)[0], is_condition(value), 0)

    def declare(self, functions: Record, definitions: Record) -> None:
        """Read all functions and definitions, whatever their order."""
        headings = {}
        for heading, body in functions.items():
            parsed = self._heading(heading)
            if parsed is not None:
                name, parameters = parsed
                if name in headings:
                    self.problems.add(("functions", heading), f"the function {name} is already declared", key=True)
                headings[name] = (heading, parameters, body)
        named = {canonical_name(name): (name, body) for name, body in definitions.items()}
        needs = {name: _references(body, parameters) for name, (_, parameters, body) in headings.items()}
        needs |= {name: _references(body, ()) for name, (_, body) in named.items()}
        try:
            order = dependency_order({n: [x for x in used if x in needs] for n, used in needs.items()})
        except CircleError as error:
            first = error.circle[0]
            path: Path = ("functions", headings[first][0]) if first in headings else ("definitions", named[first][0])
            what = "the function uses itself" if len(error.circle) == 2 and first in headings else "defined in a circle"
            self.problems.add(path, f"{what}: {error}; functions and definitions are inserted, so this never ends")
            self.problems.raise_if_any()
            raise
        for name in order:
            if name in headings:
                self._function(name, *headings[name])
            else:
                self._definition(name, *named[name])
        self.functions = {n: self.functions[n] for n in headings if n in self.functions}  # in the order of the file
        self.definitions = {n: self.definitions[n] for n in named}

    def _heading(self, heading: str) -> tuple[str, tuple[str, ...]] | None:
        path = ("functions", heading)
        match = HEADING.fullmatch(heading)
        if match is None:
            self.problems.add(path, "expected a heading such as g(u, v)", key=True)
            return None
        name = canonical_name(match.group(1))
        parameters = tuple(canonical_name(p.strip()) for p in match.group(2).split(","))
        if parameters == ("",):
            self.problems.add(path, "a function needs an argument; without one, put it under definitions", key=True)
            return None
        wrong = next((p for p in parameters if not is_name(p)), None)
        if wrong is not None:
            self.problems.add(path, f"{wrong!r} cannot name an argument", key=True)
            return None
        if len(set(parameters)) < len(parameters):
            self.problems.add(path, "two arguments have the same name", key=True)
            return None
        return name, parameters

    def _function(self, name: str, heading: str, parameters: tuple[str, ...], body: object) -> None:
        slots = placeholders(name, parameters)
        outer = self.scope
        arguments = dict(zip(parameters, slots, strict=True))
        inner = Scope(
            {**(outer.names or {}), **arguments},
            self.functions,
            self.conditions.difference(parameters),
            self.unavailable,
            self.budget,
        )
        operand = self.read_operand(body, ("functions", heading), inner)
        text = " ".join(body.split()) if isinstance(body, str) else str(body)
        self.functions[name] = Function.make(name, parameters, text, operand.node, operand.condition)

    def _definition(self, name: str, key: str, body: object) -> None:
        operand = self.read_operand(body, ("definitions", key), self.scope)
        self.definitions[name] = self.names[name] = operand.node
        if operand.condition:
            self.conditions.add(name)


def _references(body: object, parameters: tuple[str, ...]) -> list[str]:
    """Names that a body mentions; mistakes in it are found when it is parsed."""
    if isinstance(body, Expression):
        return symbols_in([body])
    if not isinstance(body, str):
        return []
    try:
        tokens = tokenize(body)
    except ExpressionError:
        return []
    calls = {t.text for t, after in pairwise(tokens) if t.kind == "name" and after.text == "("}
    names = [t.text for t in tokens if t.kind == "name" and (t.text not in parameters or t.text in calls)]
    return list(dict.fromkeys(names))
