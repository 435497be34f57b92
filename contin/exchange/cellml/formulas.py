"""Formulas of Myokit, which reads CellML for us, as trees."""

from __future__ import annotations

from typing import Final

from contin.exchange.cellml.library import myokit
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node, either, name, number, own

_BINARY: Final = {
    "Plus": "+", "Minus": "-", "Multiply": "*", "Divide": "/", "Power": "^", "Equal": "==", "NotEqual": "!=",
    "More": ">", "Less": "<", "MoreEqual": ">=", "LessEqual": "<=", "And": "and", "Or": "or",
}  # fmt: skip
_FUNCTIONS: Final = {
    "Sqrt": "sqrt", "Sin": "sin", "Cos": "cos", "Tan": "tan", "ASin": "asin", "ACos": "acos", "ATan": "atan",
    "Exp": "exp", "Log10": "log10", "Floor": "floor", "Ceil": "ceil", "Abs": "abs",
}  # fmt: skip


def tree(expression: myokit.Expression) -> Node:
    """The tree of a Myokit expression; names are those of its variables with their components."""
    kind = type(expression).__name__
    if kind == "Number":
        return number(repr(float(expression.eval())))
    if kind == "Name":
        return name(expression.var().qname())
    if kind == "Derivative":
        raise FormulaError(f"the derivative {expression.code()} as part of a formula")
    args = [tree(operand) for operand in expression]
    if kind in _BINARY:
        return Node(_BINARY[kind], tuple(args))
    if kind in _FUNCTIONS:
        return own(_FUNCTIONS[kind], *args)
    if kind == "PrefixMinus":
        return Node("neg", tuple(args))
    if kind == "PrefixPlus":
        return args[0]
    if kind == "Not":
        return Node("not", tuple(args))
    if kind == "Log":
        return own("log", args[0]) if len(args) == 1 else Node("/", (own("log", args[0]), own("log", args[1])))
    if kind == "Quotient":
        return own("floor", Node("/", (args[0], args[1])))
    if kind == "Remainder":
        return Node("-", (args[0], Node("*", (args[1], own("floor", Node("/", (args[0], args[1])))))))
    if kind == "If":
        return either(*args)
    if kind == "Piecewise":
        found = args[-1]
        for k in range(len(args) - 3, -1, -2):
            found = either(args[k], args[k + 1], found)
        return found
    raise FormulaError(f"{kind}: {expression.code()[:60]} has no equal here")
