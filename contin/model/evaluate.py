"""Values of expressions in double precision (math) or in many digits (mpmath), for checks and single points.

Follows IEEE arithmetic like the machine code: nothing is raised, division by zero gives an infinity, a logarithm of a
negative number gives NaN. Conditions have the values True and False.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, cast

from contin.machine import elementary
from contin.model.expression import COMPARISONS, Expression, postorder
from contin.model.vocabulary import STEPWISE
from contin.records import Record

if TYPE_CHECKING:
    from types import ModuleType

Value = Any  # float, or mpmath's mpf

_RENAMED: Final = {"abs": "fabs"}


def evaluate(expression: Expression, env: Record, lib: object = math) -> Value:
    """Value of one expression where the symbols have the values `env`; `lib` is `math` or `mpmath`."""
    return evaluate_all([expression], env, lib)[0]


def evaluate_all(expressions: Iterable[Expression], env: Record, lib: object = math) -> list[Value]:
    """Values of several expressions; what they share is computed once. O(nodes)."""
    roots = tuple(expressions)
    values = _values(roots, env, lib)
    places = _steps(roots).places
    return [values[places[root]] for root in roots]


def node_values(roots: Iterable[Expression], env: Record, lib: Any = math) -> dict[Expression, Value]:
    """Value of every node below `roots`."""
    roots = tuple(roots)
    return dict(zip(_steps(roots).places, _values(roots, env, lib), strict=True))


@dataclass(frozen=True, eq=False)
class _Steps:
    """Every node below some roots, operands before their users: kind, its own value, the places of its operands."""

    each: tuple[tuple[str, Any, tuple[int, ...]], ...]
    places: Mapping[Expression, int]


@lru_cache(maxsize=256)
def _steps(roots: tuple[Expression, ...]) -> _Steps:
    """Formulas that are evaluated are evaluated again. Numbers are told as doubles beside what they are."""
    order = postorder(roots)
    places = {node: k for k, node in enumerate(order)}
    return _Steps(tuple((node.op, _own(node), tuple(places[a] for a in node.args)) for node in order), places)


def _own(node: Expression) -> Any:
    """A symbol's name; of a number its value, and that as a double (None: too large for one)."""
    if node.op == "symbol":
        return str(node.value)
    if node.op != "number":
        return None
    try:
        return node.value, float(cast(Any, node.value))
    except OverflowError:
        return node.value, None


def _values(roots: tuple[Expression, ...], env: Record, lib: Any) -> list[Value]:
    """Of every node, in the order of `_steps`."""
    arithmetic = _Arithmetic(lib)
    doubles = arithmetic.real is float
    values: list[Value] = []
    for op, own, operands in _steps(roots).each:
        if op == "symbol":
            values.append(env[own])
        elif op == "number":
            values.append(own[1] if doubles and own[1] is not None else arithmetic.constant(own[0]))
        elif op == "pi":
            values.append(+lib.pi)
        else:
            values.append(arithmetic.apply(op, [values[k] for k in operands]))
    return values


class _Arithmetic:
    """The operations over one number type."""

    def __init__(self, lib: ModuleType) -> None:
        self.lib = lib
        self.real: Callable[[Any], Any] = float if lib is math else lib.mpf
        self.nan = self.real("nan")
        self.inf = self.real("inf")

    def constant(self, value: object) -> Value:
        if isinstance(value, Fraction) and self.real is not float:
            return self.real(value.numerator) / value.denominator
        return self.real(value)

    def apply(self, op: str, x: list[Value]) -> Value:
        if op == "add":
            return sum(x[1:], x[0])
        if op == "mul":
            product = x[0]
            for factor in x[1:]:
                product = product * factor
            return product
        if op == "if":
            return x[1] if x[0] else x[2]
        if op in COMPARISONS:
            return _compare(op, x[0], x[1])
        if op == "and":
            return all(x)
        if op == "or":
            return any(x)
        if op == "not":
            return not x[0]
        if any(v != v for v in x):
            return self.nan
        if op == "pow":
            return self.power(x[0], x[1])
        return self.function(op, x)

    def power(self, base: Value, exponent: Value) -> Value:
        if exponent == -1:
            return 1 / base if base != 0 else self.inf
        if base == 0 and exponent < 0:
            return self.inf
        try:
            result = elementary.pow(base, exponent) if self.real is float else base**exponent
        except OverflowError:
            return -self.inf if base < 0 and exponent % 2 == 1 else self.inf
        except ValueError:
            return self.nan
        return self.nan if isinstance(result, complex) or hasattr(result, "_mpc_") else result

    def function(self, op: str, x: list[Value]) -> Value:
        a = x[0]
        if op == "min":
            return min(x)
        if op == "max":
            return max(x)
        if op == "sign":
            return self.real((a > 0) - (a < 0))
        if op == "heaviside":
            return self.real(0.5 if a == 0 else float(a > 0))
        if op in STEPWISE:
            return self.step(op, x)
        if (op in ("log", "log10") and a == 0) or (op == "log1p" and a == -1):
            return -self.inf
        try:
            ours = self.real is float and op in elementary.FUNCTIONS
            result = getattr(elementary if ours else self.lib, _RENAMED.get(op, op))(*x)
        except OverflowError:
            return -self.inf if a < 0 and op == "sinh" else self.inf
        except ValueError:
            return self.nan
        return self.nan if hasattr(result, "_mpc_") else result

    def step(self, op: str, x: list[Value]) -> Value:
        """floor, ceil, mod (of the divisor's sign) and factorial (of whole numbers, NaN elsewhere)."""
        a = x[0]
        if op == "factorial":
            return self.real(factorial(float(a)))
        if abs(a) == self.inf:
            return self.nan if op == "mod" else a
        if op != "mod":
            return self.real(math.floor(a) if op == "floor" else math.ceil(a))
        if x[1] == 0:
            return self.nan
        return a % x[1]


def factorial(x: float) -> float:
    """x! of whole numbers, infinite beyond 170; NaN of others."""
    if not (x >= 0.0 and (x == math.inf or x == math.floor(x))):
        return math.nan
    return float(math.factorial(int(x))) if x <= 170.0 else math.inf


def _compare(op: str, a: Value, b: Value) -> bool:
    if op == "<":
        return bool(a < b)
    if op == "<=":
        return bool(a <= b)
    if op == ">":
        return bool(a > b)
    if op == ">=":
        return bool(a >= b)
    return bool(a == b) if op == "==" else bool(a != b)
