"""First derivatives in numbers: value and directional derivative of expressions together (forward mode)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from contin.model.evaluate import node_values
from contin.model.expression import COMPARISONS, LOGICAL, Expression, postorder


def directional(
    expressions: Iterable[Expression], env: Mapping[str, float], direction: Mapping[str, float]
) -> list[float]:
    """d/dh of each expression at env + h*direction, h = 0; symbols that `direction` lacks stay fixed. O(nodes).

    Where a function has no derivative (abs at 0, a jump) one of the one-sided ones, or 0, is taken; NaN where the
    value is not finite.
    """
    roots = list(expressions)
    values = node_values(roots, env)
    slopes: dict[Expression, float] = {}
    for node in postorder(roots):
        if node.op == "symbol":
            slopes[node] = direction.get(str(node.value), 0.0)
        elif not node.args or node.op in COMPARISONS or node.op in LOGICAL:
            slopes[node] = 0.0
        else:
            try:
                slopes[node] = _slope(node, values, [slopes[a] for a in node.args])
            except (ZeroDivisionError, OverflowError, ValueError):
                slopes[node] = math.nan
    return [slopes[root] for root in roots]


def _slope(node: Expression, values: Mapping[Expression, float], d: list[float]) -> float:
    op = node.op
    if op == "add":
        return math.fsum(d)
    x = [values[a] for a in node.args]
    if op == "if":
        return d[1] if x[0] else d[2]
    if all(v == 0.0 for v in d):
        return 0.0
    if op == "mul":
        return math.fsum(d[i] * math.prod(x[:i] + x[i + 1 :]) for i in range(len(x)) if d[i] != 0.0)
    if op == "pow":
        base, exponent = x
        slope = d[0] * exponent * math.pow(base, exponent - 1.0) if d[0] != 0.0 else 0.0
        return slope + (d[1] * math.log(base) * values[node] if d[1] != 0.0 else 0.0)
    if op in ("min", "max"):
        return d[0] if values[node] == x[0] else d[1]
    if op == "atan2":
        return (x[1] * d[0] - x[0] * d[1]) / (x[0] ** 2 + x[1] ** 2)
    return d[0] * _derivative(op, x[0], values[node])


def _derivative(op: str, x: float, y: float) -> float:
    """Derivative at x of a function of one argument whose value there is y."""
    table = {
        "sin": lambda: math.cos(x),
        "cos": lambda: -math.sin(x),
        "tan": lambda: 1.0 + y * y,
        "asin": lambda: 1.0 / math.sqrt(1.0 - x * x),
        "acos": lambda: -1.0 / math.sqrt(1.0 - x * x),
        "atan": lambda: 1.0 / (1.0 + x * x),
        "sinh": lambda: math.cosh(x),
        "cosh": lambda: math.sinh(x),
        "tanh": lambda: 1.0 - y * y,
        "exp": lambda: y,
        "expm1": lambda: y + 1.0,
        "log": lambda: 1.0 / x,
        "log1p": lambda: 1.0 / (1.0 + x),
        "log10": lambda: 1.0 / (x * math.log(10.0)),
        "sqrt": lambda: 0.5 / y,
        "abs": lambda: math.copysign(1.0, x),
        "sign": lambda: 0.0,
        "heaviside": lambda: 0.0,
    }
    return table[op]()
