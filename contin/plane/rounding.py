"""How large the terms are that cancel where the equations vanish: what is left of them there is rounding."""

from __future__ import annotations

from contin.lowering import compile_system
from contin.lowering.system import CompiledSystem
from contin.model.expression import Expression, add, call, is_condition, mul, neg, numeric_value, postorder, power
from contin.model.model import Model

SIZE = "size of the terms of "  # no name in a model contains a blank


def plane_system(model: Model) -> CompiledSystem:
    """Compiled with an observable for each equation: the sum of the moduli of its terms, products multiplied out."""
    found: dict[Expression, Expression] = {}
    for node in postorder(model.equations):
        found[node] = _size(node, found)
    sizes = {SIZE + n: found[e] for n, e in zip(model.state_names, model.equations, strict=True)}
    return compile_system(model.replace(observables=sizes))


def _size(node: Expression, known: dict[Expression, Expression]) -> Expression:
    if node.op == "number":
        return neg(node) if numeric_value(node) < 0 else node
    if node.op in ("add", "mul"):
        return (add if node.op == "add" else mul)(*(known[a] for a in node.args))
    if node.op == "pow" and node.args[1].op == "number" and numeric_value(node.args[1]) > 0:
        return power(known[node.args[0]], node.args[1])
    return node if is_condition(node) else call("abs", node)
