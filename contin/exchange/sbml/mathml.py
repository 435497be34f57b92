"""MathML of an SBML file -> formulas in contin's grammar.

Conditions and numbers are kept apart as the grammar wants it: a condition where a number stands is 1 or 0, a number
where a condition stands is true unless it is 0 (SBML level 3 version 2 allows both). Function definitions are inserted.
A piecewise without `otherwise` is not a number where no piece holds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import libsbml

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError

Node = Any  # libsbml's ASTNode

AVOGADRO: Final = "6.02214179e23"  # as the specification of level 3 has it
NAN, INFINITY = "log(-1)", "(1/0)"  # formulas of the grammar with these values
MAX_LENGTH: Final = 900_000  # characters of one formula
MAX_DEPTH: Final = 400

Translate = Callable[[Sequence[str]], str]


@dataclass(frozen=True)
class Scope:
    """What names stand for: identifiers (formulas), function definitions, and where we are, for messages."""

    names: Mapping[str, str]
    functions: Mapping[str, Node] = field(default_factory=dict)
    time: str = "t"
    where: str = ""


def number(node: Node, scope: Scope, depth: int = 0) -> str:
    """The formula of a node whose value is a number."""
    text, condition = _translated(node, scope, depth)
    return f"(1 if {text} else 0)" if condition else text


def condition(node: Node, scope: Scope, depth: int = 0) -> str:
    """The formula of a node whose value is true or false."""
    text, is_condition = _translated(node, scope, depth)
    return text if is_condition else f"({text} != 0)"


def _translated(node: Node, scope: Scope, depth: int) -> tuple[str, bool]:
    if depth > MAX_DEPTH:
        raise InputError(f"{scope.where}: formulas are nested deeper than {MAX_DEPTH} levels")
    kind = node.getType()
    if kind in _REFUSED:
        raise UnsupportedError(f"{scope.where}: {_REFUSED[kind]} is not supported")
    if kind in _LOGICAL or kind in _RELATIONS or kind in (libsbml.AST_CONSTANT_TRUE, libsbml.AST_CONSTANT_FALSE):
        return _condition(node, kind, scope, depth + 1), True
    if kind == libsbml.AST_FUNCTION:
        return _call(node, scope, depth + 1)
    text = _number(node, kind, scope, depth + 1)
    if len(text) > MAX_LENGTH:
        raise InputError(f"{scope.where}: longer than {MAX_LENGTH} characters when functions are inserted")
    return text, False


def _children(node: Node) -> list[Node]:
    return [node.getChild(k) for k in range(node.getNumChildren())]


def _number(node: Node, kind: int, scope: Scope, depth: int) -> str:
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
    rule = _NUMBERS.get(kind)
    if rule is None:
        raise UnsupportedError(f"{scope.where}: <{node.getName() or kind}> is not supported")
    return rule([number(child, scope, depth) for child in _children(node)])


def _constant(node: Node, kind: int) -> str:
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


def _piecewise(node: Node, scope: Scope, depth: int) -> str:
    children = _children(node)
    otherwise = number(children.pop(), scope, depth) if len(children) % 2 else NAN
    for value, test in reversed(list(zip(children[::2], children[1::2], strict=True))):
        otherwise = f"({number(value, scope, depth)} if {condition(test, scope, depth)} else {otherwise})"
    return otherwise


def _condition(node: Node, kind: int, scope: Scope, depth: int) -> str:
    if kind in (libsbml.AST_CONSTANT_TRUE, libsbml.AST_CONSTANT_FALSE):
        return "(0 < 1)" if kind == libsbml.AST_CONSTANT_TRUE else "(1 < 0)"
    if kind in _RELATIONS:
        sides = [number(child, scope, depth) for child in _children(node)]
        if len(sides) < 2:
            return "(0 < 1)"
        return "(" + f" {_RELATIONS[kind]} ".join(sides) + ")"
    parts = [condition(child, scope, depth) for child in _children(node)]
    return _LOGICAL[kind](parts)


def _all(parts: Sequence[str]) -> str:
    return "(" + " and ".join(parts) + ")" if parts else "(0 < 1)"


def _any(parts: Sequence[str]) -> str:
    return "(" + " or ".join(parts) + ")" if parts else "(1 < 0)"


def _xor(parts: Sequence[str]) -> str:
    """True where an odd number of operands is."""
    count = " + ".join(f"(1 if {p} else 0)" for p in parts)
    return f"(mod({count}, 2) > 0.5)" if parts else "(1 < 0)"


def _call(node: Node, scope: Scope, depth: int) -> tuple[str, bool]:
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


def _of(name: str) -> Translate:
    return lambda x: f"{name}({x[0]})"


def _inverse_of(name: str) -> Translate:
    return lambda x: f"{name}(1/({x[0]}))"


def _reciprocal(name: str) -> Translate:
    return lambda x: f"(1/{name}({x[0]}))"


def _joined(operator: str, empty: str) -> Translate:
    return lambda x: "(" + f" {operator} ".join(x) + ")" if x else empty


def _extreme(name: str) -> Translate:
    return lambda x: f"{name}({', '.join(x)})" if len(x) > 1 else x[0]


def _minus(x: Sequence[str]) -> str:
    return f"(-{x[0]})" if len(x) == 1 else f"({x[0]} - {x[1]})"


def _log(x: Sequence[str]) -> str:
    base, value = x if len(x) == 2 else ("10", x[0])
    return f"log10({value})" if base in ("10", "10.0") else f"(log({value})/log({base}))"


def _root(x: Sequence[str]) -> str:
    degree, value = x if len(x) == 2 else ("2", x[0])
    return f"sqrt({value})" if degree in ("2", "2.0") else f"(({value})^(1/({degree})))"


def _quotient(x: Sequence[str]) -> str:
    """The whole part of a/b, towards 0."""
    ratio = f"({x[0]})/({x[1]})"
    return f"(floor({ratio}) if {ratio} >= 0 else ceil({ratio}))"


def _remainder(x: Sequence[str]) -> str:
    """a - b quotient(a, b), of the sign of a."""
    return f"(sign({x[0]})*mod(abs({x[0]}), abs({x[1]})))"


_REFUSED: Final = {
    libsbml.AST_FUNCTION_DELAY: "<csymbol> delay",
    libsbml.AST_FUNCTION_RATE_OF: "<csymbol> rateOf",
}
_LOGICAL: Final[Mapping[int, Translate]] = {
    libsbml.AST_LOGICAL_AND: _all,
    libsbml.AST_LOGICAL_OR: _any,
    libsbml.AST_LOGICAL_XOR: _xor,
    libsbml.AST_LOGICAL_NOT: lambda x: f"(not {x[0]})",
    libsbml.AST_LOGICAL_IMPLIES: lambda x: f"((not {x[0]}) or {x[1]})",
}
_RELATIONS: Final = {
    libsbml.AST_RELATIONAL_EQ: "==",
    libsbml.AST_RELATIONAL_NEQ: "!=",
    libsbml.AST_RELATIONAL_LT: "<",
    libsbml.AST_RELATIONAL_LEQ: "<=",
    libsbml.AST_RELATIONAL_GT: ">",
    libsbml.AST_RELATIONAL_GEQ: ">=",
}
_SAME: Final = "sin cos tan sinh cosh tanh exp abs floor factorial".split()
_ARCS: Final = "sin cos tan sinh cosh tanh".split()
_OTHERS: Final = {"sec": "cos", "csc": "sin", "cot": "tan", "sech": "cosh", "csch": "sinh", "coth": "tanh"}


def _kind(name: str) -> int:
    return int(getattr(libsbml, f"AST_FUNCTION_{name.upper()}"))


_NUMBERS: Final[Mapping[int, Translate]] = {
    libsbml.AST_PLUS: _joined("+", "0"),
    libsbml.AST_TIMES: _joined("*", "1"),
    libsbml.AST_MINUS: _minus,
    libsbml.AST_DIVIDE: lambda x: f"({x[0]}/({x[1]}))",
    **dict.fromkeys((libsbml.AST_POWER, libsbml.AST_FUNCTION_POWER), lambda x: f"(({x[0]})^({x[1]}))"),
    libsbml.AST_FUNCTION_ROOT: _root,
    libsbml.AST_FUNCTION_LOG: _log,
    libsbml.AST_FUNCTION_LN: _of("log"),
    libsbml.AST_FUNCTION_CEILING: _of("ceil"),
    libsbml.AST_FUNCTION_MIN: _extreme("min"),
    libsbml.AST_FUNCTION_MAX: _extreme("max"),
    libsbml.AST_FUNCTION_QUOTIENT: _quotient,
    libsbml.AST_FUNCTION_REM: _remainder,
    **{_kind(name): _of(name) for name in _SAME},
    **{_kind(f"arc{name}"): _of(f"a{name}") for name in _ARCS},
    **{_kind(name): _reciprocal(other) for name, other in _OTHERS.items()},
    **{_kind(f"arc{name}"): _inverse_of(f"a{other}") for name, other in _OTHERS.items()},
}
"""Functions and operators of MathML; arccot x = atan(1/x) and its like, as the specification leaves them."""
