"""MathML of an SBML file -> formulas in contin's grammar.

Conditions and numbers are kept apart as the grammar wants it: a condition where a number stands is 1 or 0, a number
where a condition stands is true unless it is 0 (SBML level 3 version 2 allows both). Function definitions are inserted.
A piecewise without `otherwise` is not a number where no piece holds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import libsbml

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.operators import LOGICAL, NUMBERS, RELATIONS

AVOGADRO: Final = "6.02214179e23"  # as the specification of level 3 has it
NAN, INFINITY = "log(-1)", "(1/0)"  # formulas of the grammar with these values
MAX_LENGTH: Final = 900_000  # characters of one formula
MAX_DEPTH: Final = 400
_REFUSED: Final = {
    libsbml.AST_FUNCTION_DELAY: "<csymbol> delay",
    libsbml.AST_FUNCTION_RATE_OF: "<csymbol> rateOf",
}


@dataclass(frozen=True)
class Scope:
    """What names stand for: identifiers (formulas), function definitions, and where we are, for messages."""

    names: Mapping[str, str]
    functions: Mapping[str, Element] = field(default_factory=dict)
    time: str = "t"
    where: str = ""


def number(node: Element, scope: Scope, depth: int = 0) -> str:
    """The formula of a node whose value is a number."""
    text, condition = _translated(node, scope, depth)
    return f"(1 if {text} else 0)" if condition else text


def condition(node: Element, scope: Scope, depth: int = 0) -> str:
    """The formula of a node whose value is true or false."""
    text, is_condition = _translated(node, scope, depth)
    return text if is_condition else f"({text} != 0)"


def _translated(node: Element, scope: Scope, depth: int) -> tuple[str, bool]:
    if depth > MAX_DEPTH:
        raise InputError(f"{scope.where}: formulas are nested deeper than {MAX_DEPTH} levels")
    kind = node.getType()
    if kind in _REFUSED:
        raise UnsupportedError(f"{scope.where}: {_REFUSED[kind]} is not supported")
    if kind in LOGICAL or kind in RELATIONS or kind in (libsbml.AST_CONSTANT_TRUE, libsbml.AST_CONSTANT_FALSE):
        return _condition(node, kind, scope, depth + 1), True
    if kind == libsbml.AST_FUNCTION:
        return _call(node, scope, depth + 1)
    text = _number(node, kind, scope, depth + 1)
    if len(text) > MAX_LENGTH:
        raise InputError(f"{scope.where}: longer than {MAX_LENGTH} characters when functions are inserted")
    return text, False


def _children(node: Element) -> list[Element]:
    return [node.getChild(k) for k in range(node.getNumChildren())]


def _number(node: Element, kind: int, scope: Scope, depth: int) -> str:
    if node.isNumber() or kind in (libsbml.AST_CONSTANT_E, libsbml.AST_CONSTANT_PI):
        return _constant(node, kind)
    if kind == libsbml.AST_NAME_TIME:
        return scope.time
    if kind == libsbml.AST_NAME_AVOGADRO:
        return AVOGADRO
    if kind == libsbml.AST_NAME:
        name = node.getName()
        if name not in scope.names:
            raise InputError(f"{scope.where}: {name!r} is not declared")
        return scope.names[name]
    if kind == libsbml.AST_FUNCTION_PIECEWISE:
        return _piecewise(node, scope, depth)
    rule = NUMBERS.get(kind)
    if rule is None:
        raise UnsupportedError(f"{scope.where}: <{node.getName() or kind}> is not supported")
    return rule([number(child, scope, depth) for child in _children(node)])


def _constant(node: Element, kind: int) -> str:
    if kind == libsbml.AST_CONSTANT_PI:
        return "pi"
    if kind == libsbml.AST_CONSTANT_E:
        return "exp(1)"
    if kind == libsbml.AST_RATIONAL:
        return f"({node.getNumerator()}/{node.getDenominator()})"
    if kind == libsbml.AST_INTEGER:
        return _signed(str(node.getInteger()))
    return literal(node.getReal())


def literal(value: float) -> str:
    """A number as a formula; also those that are not finite."""
    if value != value:
        return NAN
    if value in (float("inf"), float("-inf")):
        return INFINITY if value > 0 else f"(-{INFINITY})"
    return _signed(repr(value))


def _signed(text: str) -> str:
    return f"({text})" if text.startswith("-") else text


def _piecewise(node: Element, scope: Scope, depth: int) -> str:
    children = _children(node)
    otherwise = number(children.pop(), scope, depth) if len(children) % 2 else NAN
    for value, test in reversed(list(zip(children[::2], children[1::2], strict=True))):
        otherwise = f"({number(value, scope, depth)} if {condition(test, scope, depth)} else {otherwise})"
    return otherwise


def _condition(node: Element, kind: int, scope: Scope, depth: int) -> str:
    if kind in (libsbml.AST_CONSTANT_TRUE, libsbml.AST_CONSTANT_FALSE):
        return "(0 < 1)" if kind == libsbml.AST_CONSTANT_TRUE else "(1 < 0)"
    if kind in RELATIONS:
        sides = [number(child, scope, depth) for child in _children(node)]
        if len(sides) < 2:
            return "(0 < 1)"
        return "(" + f" {RELATIONS[kind]} ".join(sides) + ")"
    parts = [condition(child, scope, depth) for child in _children(node)]
    return LOGICAL[kind](parts)


def _call(node: Element, scope: Scope, depth: int) -> tuple[str, bool]:
    """A function definition with its arguments put in."""
    name = node.getName()
    if name not in scope.functions:
        raise InputError(f"{scope.where}: the function {name!r} is not defined")
    definition = scope.functions[name]
    count = definition.getNumArguments()
    arguments = [_translated(child, scope, depth) for child in _children(node)]
    if len(arguments) != count:
        raise InputError(f"{scope.where}: {name} takes {count} arguments, got {len(arguments)}")
    body = definition.getBody()
    if body is None:
        return NAN, False
    given = {definition.getArgument(k).getName(): _as_number(*arguments[k]) for k in range(count)}
    inner = Scope(given, scope.functions, scope.time, f"{scope.where}, function {name}")
    text, is_condition = _translated(body, inner, depth)
    return f"({text})", is_condition


def _as_number(text: str, is_condition: bool) -> str:
    return f"(1 if {text} else 0)" if is_condition else f"({text})"
