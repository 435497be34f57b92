"""Operators and functions of MathML: from the formulas of operands to the formula of the result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import libsbml

Translate = Callable[[Sequence[str]], str]


def _all(parts: Sequence[str]) -> str:
    return "(" + " and ".join(parts) + ")" if parts else "(0 < 1)"


def _any(parts: Sequence[str]) -> str:
    return "(" + " or ".join(parts) + ")" if parts else "(1 < 0)"


def _xor(parts: Sequence[str]) -> str:
    """True where an odd number of operands is."""
    odd = parts[0] if parts else "(1 < 0)"
    for part in parts[1:]:
        odd = f"(({odd} and not {part}) or ({part} and not {odd}))"
    return odd


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


LOGICAL: Final[Mapping[int, Translate]] = {
    libsbml.AST_LOGICAL_AND: _all,
    libsbml.AST_LOGICAL_OR: _any,
    libsbml.AST_LOGICAL_XOR: _xor,
    libsbml.AST_LOGICAL_NOT: lambda x: f"(not {x[0]})",
    libsbml.AST_LOGICAL_IMPLIES: lambda x: f"((not {x[0]}) or {x[1]})",
}
RELATIONS: Final = {
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


NUMBERS: Final[Mapping[int, Translate]] = {
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
