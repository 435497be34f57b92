"""Formulas in arrays: one pass of numpy over the graph of all of them, real or complex."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, Final, cast

import numpy as np

from contin.abi import Vector
from contin.machine import elementary
from contin.model.evaluate import factorial
from contin.model.expression import Expression, postorder

Values = Mapping[str, Any]  # arrays of one length, or numbers
_OURS: Final = "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp expm1 log log1p log10 pow".split()


def _elementary(name: str) -> Callable[..., Any]:
    """The function with the same bits on every processor, for real numbers; numpy's for complex ones."""
    ours = getattr(elementary, name)
    general = getattr(np, name.replace("a", "arc", 1) if name[0] == "a" else "power" if name == "pow" else name)

    def function(*x: Any) -> Any:
        if any(np.iscomplexobj(a) for a in x):
            return general(*x)
        return ours(*(np.asarray(a, dtype=float) for a in x))

    return function


def _sum(*x: Any) -> Any:
    return sum(x[1:], x[0])


def _product(*x: Any) -> Any:
    total = x[0]
    for factor in x[1:]:
        total = total * factor
    return total


def _power(base: Any, exponent: Any) -> Any:
    if np.ndim(exponent) == 0 and float(np.real(exponent)).is_integer() and abs(exponent) <= 16 and exponent != 0:
        count = int(np.real(exponent))
        power = _product(*[base] * abs(count))
        return power if count > 0 else np.divide(1.0, power)
    return _elementary_power(base, exponent)


_elementary_power = _elementary("pow")
_FUNCTIONS: Final[dict[str, Callable[..., Any]]] = {
    **{name: _elementary(name) for name in _OURS}, "sqrt": np.sqrt,
    "add": _sum, "mul": _product, "pow": _power,
    "abs": np.abs, "sign": np.sign, "min": np.minimum, "max": np.maximum,
    "floor": np.floor, "ceil": np.ceil, "mod": np.mod, "heaviside": lambda x: np.heaviside(x, 0.5),
    "factorial": np.vectorize(factorial, otypes=[float]),
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal, "==": np.equal, "!=": np.not_equal,
    "not": np.logical_not, "if": np.where,
    "and": lambda *x: np.logical_and.reduce(np.broadcast_arrays(*x)),
    "or": lambda *x: np.logical_or.reduce(np.broadcast_arrays(*x)),
}  # fmt: skip
_CONSTANTS: Final = ("number", "pi")


class ArrayFormulas:
    """Several formulas, evaluated together."""

    def __init__(self, formulas: Sequence[Expression]) -> None:
        order = postorder(formulas)
        place = {node: k for k, node in enumerate(order)}
        self._constants = [_constant(node) if node.op in _CONSTANTS else None for node in order]
        self._symbols = [(k, str(node.value)) for k, node in enumerate(order) if node.op == "symbol"]
        self._steps = [
            (k, _FUNCTIONS[node.op], tuple(place[a] for a in node.args))
            for k, node in enumerate(order)
            if node.op not in (*_CONSTANTS, "symbol")
        ]
        self._roots = [place[f] for f in formulas]

    def __call__(self, values: Values, size: int | tuple[int, ...]) -> list[Vector]:
        """The value of each formula, of this shape."""
        done: list[Any] = self._constants.copy()
        for k, name in self._symbols:
            done[k] = values[name]
        with np.errstate(all="ignore"):  # what is not finite is told where it matters
            for k, function, arguments in self._steps:
                done[k] = function(*[done[a] for a in arguments])
            shape = size if isinstance(size, tuple) else (size,)
            found = [np.asarray(done[root]) for root in self._roots]
            return [x if x.shape == shape else np.broadcast_to(x, shape) for x in found]


def _constant(node: Expression) -> float:
    return np.pi if node.op == "pi" else float(cast(Fraction | float, node.value))
