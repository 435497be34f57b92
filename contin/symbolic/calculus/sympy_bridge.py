"""Expressions <-> sympy objects, node by node: text never reaches sympy, and sympy is imported when first needed.

Numbers cross exactly in both directions. Symbols are real; those named in `positive` are positive to sympy, which is an
assumption that the caller has to state. Names may be anything: they are only labels to sympy.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from contin.errors import ContinError
from contin.model.expression import (
    COMPARISONS,
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    call,
    compare,
    if_,
    logical,
    mul,
    number,
    numeric_value,
    postorder,
    power,
    symbol,
)
from contin.model.walk import from_operands
from contin.records import Sympy

if TYPE_CHECKING:
    from types import ModuleType


class BridgeError(ContinError, TypeError):
    """A sympy object that the grammar of contin cannot express."""


def to_sympy(expression: Expression, positive: Collection[str] = ()) -> Sympy:
    """The same formula as a sympy object."""
    return all_to_sympy([expression], positive)[0]


def all_to_sympy(expressions: list[Expression], positive: Collection[str] = ()) -> list[Sympy]:
    """Several formulas; what they share is converted once."""
    import sympy

    done: dict[Expression, Sympy] = {}
    for node in postorder(expressions):
        done[node] = _to(sympy, node, [done[a] for a in node.args], positive)
    return [done[e] for e in expressions]


def sympy_symbol(name: str, positive: bool = False) -> Sympy:
    """The sympy symbol that stands for a symbol of ours."""
    import sympy

    return sympy.Symbol(name, positive=True) if positive else sympy.Symbol(name, real=True)


def _to(sympy: ModuleType, node: Expression, args: list[Sympy], positive: Collection[str]) -> Sympy:
    op = node.op
    if op == "number":
        value = numeric_value(node)
        return sympy.Rational(*Fraction(value).as_integer_ratio())
    if op == "symbol":
        name = str(node.value)
        return sympy_symbol(name, name in positive)
    if op == "pi":
        return sympy.pi
    if op == "add":
        return sympy.Add(*args)
    if op == "mul":
        return sympy.Mul(*args)
    if op == "pow":
        return sympy.Pow(*args)
    if op == "if":
        return sympy.Piecewise((args[1], args[0]), (args[2], True))
    if op in COMPARISONS:
        return _RELATIONS[op](sympy)(*args)
    if op in ("and", "or", "not"):
        return {"and": sympy.And, "or": sympy.Or, "not": sympy.Not}[op](*args)
    return _FUNCTIONS[op](sympy, *args)


_RELATIONS: Final[dict[str, Callable[[Sympy], Sympy]]] = {
    "<": lambda s: s.Lt,
    "<=": lambda s: s.Le,
    ">": lambda s: s.Gt,
    ">=": lambda s: s.Ge,
    "==": lambda s: s.Eq,
    "!=": lambda s: s.Ne,
}

_SAME_NAME: Final = frozenset(
    "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log sqrt atan2 sign floor factorial".split()
)

_FUNCTIONS: Final[dict[str, Callable[..., Sympy]]] = {
    **{name: (lambda s, *x, _name=name: getattr(s, _name)(*x)) for name in _SAME_NAME},
    "expm1": lambda s, x: s.exp(x) - 1,
    "log1p": lambda s, x: s.log(1 + x),
    "log10": lambda s, x: s.log(x) / s.log(10),
    "abs": lambda s, x: s.Abs(x),
    "heaviside": lambda s, x: s.Heaviside(x, s.Rational(1, 2)),
    "ceil": lambda s, x: s.ceiling(x),
    "mod": lambda s, x, y: s.Mod(x, y),
    "min": lambda s, *x: s.Min(*x),
    "max": lambda s, *x: s.Max(*x),
}


def from_sympy(value: Sympy) -> Expression:
    """The same formula as an expression; sums and products in sympy's printing order.

    Raises `BridgeError` for anything outside the grammar (complex numbers, unevaluated integrals, special functions).
    """
    return from_operands(value, _operands, lambda item, parts: _from(item, list(parts)))


def _operands(item: Sympy) -> tuple[Sympy, ...]:
    if item.is_Add:
        return tuple(item.as_ordered_terms())
    if item.is_Mul:
        return tuple(item.as_ordered_factors())
    if item.is_Pow and item.exp.is_Rational:
        return (item.base,)
    if item.is_Piecewise:
        return tuple(part for pair in item.args for part in pair.args)
    return tuple(item.args)


def _from(item: Sympy, args: list[Expression]) -> Expression:
    import sympy

    if item.is_Rational:
        return number(_exact(Fraction(int(item.p), int(item.q))))
    if item.is_Float:
        return number(float(item))
    if item is sympy.pi:
        return PI
    if item is sympy.E:
        return call("exp", ONE)
    if item.is_Symbol:
        return symbol(item.name)
    if item in (sympy.true, sympy.false):
        return ONE if item is sympy.true else ZERO
    if item.is_Add:
        return add(*args)
    if item.is_Mul:
        return _product(args)
    if item.is_Pow:
        return _power(args[0], Fraction(int(item.exp.p), int(item.exp.q))) if len(args) == 1 else power(*args)
    if item.is_Piecewise:
        return _piecewise(args)
    name = type(item).__name__
    if name in _BACK:
        return _BACK[name](args)
    raise BridgeError(f"the grammar has no {name}: {str(item)[:80]}")


def _exact(value: Fraction) -> Fraction | float:
    """A fraction that came from a rounded number (a long binary fraction) becomes that number again."""
    bottom = value.denominator
    return float(value) if bottom > 2**40 and bottom & (bottom - 1) == 0 else value


def _product(factors: list[Expression]) -> Expression:
    """Numerator over one denominator, as a person writes a fraction."""
    above, below = [], []
    for factor in factors:
        if factor.op == "pow" and factor.args[1].op == "number" and numeric_value(factor.args[1]) < 0:
            below.append(power(factor.args[0], number(-numeric_value(factor.args[1]))))
        elif factor.op == "number" and isinstance(factor.value, Fraction) and factor.value.denominator > 1:
            above.append(number(factor.value.numerator))
            below.insert(0, number(factor.value.denominator))
        else:
            above.append(factor)
    top = mul(*above) if above else ONE
    if not below:
        return top
    return mul(top, power(mul(*below), number(-1)))


def _power(base: Expression, exponent: Fraction) -> Expression:
    if exponent.denominator == 2:
        return power(call("sqrt", base), number(exponent.numerator))
    return power(base, number(exponent))


def _piecewise(args: list[Expression]) -> Expression:
    pairs = list(zip(args[::2], args[1::2], strict=True))
    value, condition = pairs[-1]
    if condition is not ONE:
        raise BridgeError("a piecewise formula without a last case")
    for then, condition in reversed(pairs[:-1]):
        value = if_(condition, then, value)
    return value


def _log(x: Expression) -> Expression:
    """log(1 + u) as log1p(u), which keeps its digits for small u."""
    if x.op == "add" and any(t is ONE for t in x.args):
        return call("log1p", add(*(t for t in x.args if t is not ONE)))
    return call("log", x)


def _folded(name: str) -> Callable[[list[Expression]], Expression]:
    return lambda x: call(name, *x)


_BACK: Final[dict[str, Callable[[list[Expression]], Expression]]] = {
    **{n: _folded(n) for n in _SAME_NAME - {"log", "sqrt"}},
    "ceiling": _folded("ceil"),
    "Mod": _folded("mod"),
    "log": lambda x: _log(x[0]),
    "Abs": _folded("abs"),
    "Heaviside": lambda x: call("heaviside", x[0]),
    "Min": _folded("min"),
    "Max": _folded("max"),
    "cot": lambda x: power(call("tan", x[0]), -1),
    "sec": lambda x: power(call("cos", x[0]), -1),
    "csc": lambda x: power(call("sin", x[0]), -1),
    "acot": lambda x: call("atan", power(x[0], -1)),
    "And": lambda x: logical("and", *x),
    "Or": lambda x: logical("or", *x),
    "Not": lambda x: logical("not", *x),
    "StrictLessThan": lambda x: compare("<", *x),
    "LessThan": lambda x: compare("<=", *x),
    "StrictGreaterThan": lambda x: compare(">", *x),
    "GreaterThan": lambda x: compare(">=", *x),
    "Equality": lambda x: compare("==", *x),
    "Unequality": lambda x: compare("!=", *x),
}
