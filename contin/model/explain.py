"""Why an equation is not finite at a point: the innermost part that fails, with the numbers that make it fail."""

from __future__ import annotations

import math
from collections.abc import Mapping

from contin.model.evaluate import node_values
from contin.model.expression import Expression, numeric_value, symbols_in
from contin.model.printing import is_division, to_text

_SHOWN = 120  # characters of a formula in a message


def explain_not_finite(equations: Mapping[str, Expression], env: Mapping[str, float], what: str = "equation") -> str:
    """Sentence that names the first equation that is NaN or infinite at `env` and says why; empty if all are finite."""
    values = node_values(equations.values(), env)
    for name, equation in equations.items():
        if not math.isfinite(values[equation]):
            return f"{what} {name}: {_reason(equation, values)}{_where(equation, env)}"
    return ""


def _reason(root: Expression, values: Mapping[Expression, float]) -> str:
    node, parent = root, None
    while True:
        inner = next((a for a in _taken(node, values) if not math.isfinite(values[a])), None)
        if inner is None:
            break
        node, parent = inner, node
    shown = parent if parent is not None and parent.op == "mul" and is_division(node) else node
    return f"{_quoted(shown)} is {_word(values[node])}: {_cause(node, values)}"


def _taken(node: Expression, values: Mapping[Expression, float]) -> tuple[Expression, ...]:
    """The operands that reach the value: of an 'if', only the chosen branch."""
    if node.op == "if":
        condition, then, otherwise = node.args
        return (then,) if values[condition] else (otherwise,)
    return node.args


def _cause(node: Expression, values: Mapping[Expression, float]) -> str:
    op, args = node.op, node.args
    if op == "symbol":
        return "its value is not a finite number"
    x = values[args[0]] if args else math.nan
    first = f"{_quoted(args[0])} = {x:.6g}" if args else ""
    if op == "pow":
        exponent = values[args[1]]
        if x == 0 and exponent < 0:
            return f"division by zero, {first}"
        if x < 0 and exponent != math.floor(exponent):
            return f"a power that is no integer, of a negative number, {first}"
        if is_division(node) and numeric_value(args[1]) == -1:
            return f"overflow, {first}"
        return f"overflow, {first} to the power {exponent:.6g}"
    if op in ("log", "log10"):
        return f"logarithm of {'zero' if x == 0 else 'a negative number'}, {first}"
    if op == "log1p":
        return f"logarithm of {'zero' if x == -1 else 'a negative number'}, 1 + {first}"
    if op == "sqrt":
        return f"square root of a negative number, {first}"
    if op == "acosh":
        return f"acosh below 1, {first}"
    if op == "factorial":
        return f"factorial of what is no whole number from 0 to 170, {first}"
    if op == "mod":
        return f"remainder of a division by zero, {_quoted(args[1])} = {values[args[1]]:.6g}"
    if op in ("asin", "acos", "atanh"):
        return f"{op} outside [-1, 1], {first}"
    if op in ("add", "mul"):
        return "overflow, " + ", ".join(f"{_quoted(a)} = {values[a]:.6g}" for a in args[:4])
    return f"overflow, {first}"


def _where(equation: Expression, env: Mapping[str, float]) -> str:
    names = symbols_in([equation])
    listed = ", ".join(f"{name} = {env[name]:.6g}" for name in names[:8])
    return f" (at {listed}{', ...' if len(names) > 8 else ''})" if names else ""


def _word(value: float) -> str:
    return "not a number" if value != value else "infinite"


def _quoted(node: Expression) -> str:
    text = to_text(node)
    return repr(text if len(text) <= _SHOWN else text[: _SHOWN - 4] + " ...")
