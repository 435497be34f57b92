"""Values of expressions at many points at once, for the checks that a pass makes of its own results."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.machine import elementary
from contin.model.evaluate import Value, factorial
from contin.model.expression import Expression, numeric_value, postorder
from contin.records import Record

Array = NDArray[np.float64]


def sample(expressions: Iterable[Expression], env: Record) -> list[Array]:
    """Values where the symbols are numbers or arrays of one shape; NaN and infinities as in machine code."""
    roots = list(expressions)
    values: dict[Expression, object] = {}
    with np.errstate(all="ignore"):
        for node in postorder(roots):
            if node.op == "symbol":
                values[node] = np.asarray(env[str(node.value)], dtype=float)
            elif node.op == "number":
                values[node] = np.float64(float(numeric_value(node)))
            elif node.op == "pi":
                values[node] = np.float64(np.pi)
            else:
                values[node] = _OPERATIONS[node.op](*(values[a] for a in node.args))
    shape = np.broadcast_shapes(*(np.shape(v) for v in env.values())) if env else ()
    return [np.array(np.broadcast_to(np.asarray(values[root], dtype=float), shape)) for root in roots]


def _total(*x: Value) -> Value:
    total = x[0]
    for term in x[1:]:
        total = total + term
    return total


def _product(*x: Value) -> Value:
    product = x[0]
    for factor in x[1:]:
        product = product * factor
    return product


def _all(*x: Value) -> Value:
    return np.logical_and.reduce(np.broadcast_arrays(*x))


def _any(*x: Value) -> Value:
    return np.logical_or.reduce(np.broadcast_arrays(*x))


_OPERATIONS: Final[dict[str, Callable[..., Value]]] = {
    "add": _total,
    "mul": _product,
    "pow": elementary.pow,
    "if": lambda c, a, b: np.where(np.asarray(c) != 0, a, b),
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
    "and": _all,
    "or": _any,
    "not": np.logical_not,
    "min": np.minimum,
    "max": np.maximum,
    "abs": np.abs,
    "sign": np.sign,
    "heaviside": lambda x: np.heaviside(x, 0.5),
    "sqrt": np.sqrt,
    "floor": np.floor,
    "ceil": np.ceil,
    "mod": np.mod,
    "factorial": np.vectorize(factorial, otypes=[float]),
    **{
        name: getattr(elementary, name)
        for name in "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp expm1".split()
        + "log log1p log10".split()
    },
}
