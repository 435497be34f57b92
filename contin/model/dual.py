"""First derivatives in numbers: value and directional derivative of expressions together (forward mode)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Final

from contin.model.evaluate import Value, node_values
from contin.model.expression import COMPARISONS, Expression, postorder
from contin.model.vocabulary import LOGICAL
from contin.records import Record

# Derivative at x of a function of one argument whose value there is y, with the elementary functions of `m`
_DERIVATIVES: Final[dict[str, Callable[[Value, Value, Value], Value]]] = {
    "sin": lambda m, x, y: m.cos(x),
    "cos": lambda m, x, y: -m.sin(x),
    "tan": lambda m, x, y: 1 + y * y,
    "asin": lambda m, x, y: 1 / m.sqrt(1 - x * x),
    "acos": lambda m, x, y: -1 / m.sqrt(1 - x * x),
    "atan": lambda m, x, y: 1 / (1 + x * x),
    "sinh": lambda m, x, y: m.cosh(x),
    "cosh": lambda m, x, y: m.sinh(x),
    "tanh": lambda m, x, y: 1 - y * y,
    "asinh": lambda m, x, y: 1 / m.sqrt(1 + x * x),
    "acosh": lambda m, x, y: 1 / (m.sqrt(x - 1) * m.sqrt(x + 1)),
    "atanh": lambda m, x, y: 1 / ((1 - x) * (1 + x)),
    "exp": lambda m, x, y: y,
    "expm1": lambda m, x, y: y + 1,
    "log": lambda m, x, y: 1 / x,
    "log1p": lambda m, x, y: 1 / (1 + x),
    "log10": lambda m, x, y: 1 / (x * m.log(10)),
    "sqrt": lambda m, x, y: 1 / (2 * y),
    "abs": lambda m, x, y: 1 if x >= 0 else -1,
    "sign": lambda m, x, y: 0,
    "heaviside": lambda m, x, y: 0,
    "floor": lambda m, x, y: 0,
    "ceil": lambda m, x, y: 0,
    "factorial": lambda m, x, y: 0,
}


def directional(expressions: Iterable[Expression], env: Record, direction: Record, lib: object = math) -> list[Value]:
    """d/dh of each expression at env + h*direction, h = 0; symbols that `direction` lacks stay fixed. O(nodes).

    Where a function has no derivative (abs at 0, a jump) one of the one-sided ones, or 0, is taken; NaN where the
    value is not finite. `lib` is `math` or `mpmath`.
    """
    roots = list(expressions)
    values = node_values(roots, env, lib)
    slopes: dict[Expression, object] = {}
    for node in postorder(roots):
        if node.op == "symbol":
            slopes[node] = direction.get(str(node.value), 0.0)
        elif not node.args or node.op in COMPARISONS or node.op in LOGICAL:
            slopes[node] = 0.0
        else:
            try:
                slopes[node] = _slope(node, values, [slopes[a] for a in node.args], lib)
            except (ZeroDivisionError, OverflowError, ValueError):
                slopes[node] = math.nan
    return [slopes[root] for root in roots]


def _slope(node: Expression, values: Mapping[Expression, Value], d: list[Value], lib: Value) -> Value:
    op = node.op
    x = [values[a] for a in node.args]
    if op == "if":
        return d[1] if x[0] else d[2]
    if all(v == 0 for v in d):
        return 0.0
    if op == "add":
        return lib.fsum(d)
    if op == "mul":
        return lib.fsum(d[i] * math.prod(x[:i] + x[i + 1 :]) for i in range(len(x)) if d[i] != 0)
    if op == "pow":
        base, exponent = x
        slope = d[0] * exponent * base ** (exponent - 1) if d[0] != 0 else 0.0
        return slope + (d[1] * lib.log(base) * values[node] if d[1] != 0 else 0.0)
    if op in ("min", "max"):
        return d[0] if values[node] == x[0] else d[1]
    if op == "atan2":
        return (x[1] * d[0] - x[0] * d[1]) / (x[0] * x[0] + x[1] * x[1])
    if op == "mod":  # a - b floor(a/b)
        return d[0] - d[1] * math.floor(x[0] / x[1])
    return d[0] * _DERIVATIVES[op](lib, x[0], values[node])
