"""Switching functions: where a piecewise formula changes from one smooth piece to another.

Every comparison that chooses a value gives left - right; abs, sign and heaviside of x give x; min and max of a and b
give a - b. Conditions that passes add to keep smooth formulas computable are no switching
(`contin.symbolic.calculus.guards`).
"""

from __future__ import annotations

from collections.abc import Iterable

from contin.model.expression import (
    COMPARISONS,
    Expression,
    Number,
    mask_of,
    numeric_value,
    split_coefficient,
    sub,
)
from contin.symbolic.calculus.guards import is_guard


def switching_functions(expressions: Iterable[Expression], names: Iterable[str]) -> list[Expression]:
    """Switching functions in order of occurrence, once each (equal up to a numeric factor), that depend on `names`."""
    mask = mask_of(names)
    found: dict[object, Expression] = {}
    for node in piecewise_nodes(expressions):
        if node.op in COMPARISONS or node.op in ("min", "max"):
            function = sub(*node.args)
        else:
            function = node.args[0]
        if function.mask & mask:
            found.setdefault(up_to_scale(function)[0], function)
    return list(found.values())


def piecewise_nodes(expressions: Iterable[Expression]) -> list[Expression]:
    """The piecewise nodes: comparisons, and functions with a kink or jump that contribute to a value.

    The inside of a comparison is not searched: the kink of |x| in `|x| < 1` changes no formula.
    """
    piecewise: list[Expression] = []
    seen: set[Expression] = set()
    stack = list(expressions)[::-1]
    while stack:
        node = stack.pop()
        if node in seen:
            continue
        seen.add(node)
        if node.op in COMPARISONS:
            if not is_guard(node):
                piecewise.append(node)
        elif node.op in ("abs", "sign", "heaviside", "min", "max"):
            piecewise.append(node)
            stack.extend(reversed(node.args))
        else:
            stack.extend(reversed(node.args))
    return piecewise


def up_to_scale(function: Expression) -> tuple[object, bool]:
    """A key that a x - a y, y - x and x - y share, and whether the leading coefficient is positive."""
    if function.op != "add":
        coefficient, rest = split_coefficient(function)
        return rest, coefficient > 0
    parts: dict[Expression | None, Number] = {}
    for term in function.args:
        if term.is_number:
            parts[None] = numeric_value(term)
        else:
            coefficient, rest = split_coefficient(term)
            parts[rest] = coefficient
    leading = parts[min((p for p in parts if p is not None), key=id)]
    return frozenset((rest, coefficient / leading) for rest, coefficient in parts.items()), leading > 0
