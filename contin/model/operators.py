"""Expressions built with Python's operators, in the shape the parser gives the same formula."""

from __future__ import annotations

from contin.model.expression import Expression, add, rebuild
from contin.model.walk import from_operands


def as_written(root: Expression) -> Expression:
    """`a + b + c` is (a + b) + c to Python; here it becomes one sum of three terms, as in a text. O(nodes)."""
    return from_operands(root, _operands, _made)


def _made(node: Expression, args: tuple[Expression, ...]) -> Expression:
    return add(*args) if node.op == "add" else rebuild(node, args) if args else node


def _operands(node: Expression) -> tuple[Expression, ...]:
    """The operands; of a sum whose first term is a sum, all terms from the left."""
    later: list[tuple[Expression, ...]] = []
    while node.op == "add" and node.args[0].op == "add":
        later.append(node.args[1:])
        node = node.args[0]
    return (*node.args, *(term for terms in reversed(later) for term in terms))
