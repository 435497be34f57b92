"""A formula of any language as a tree."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

COMPARISONS: Final = frozenset({"<", "<=", ">", ">=", "==", "!="})
LOGICAL: Final = frozenset({"and", "or", "not"})
ARITHMETIC: Final = frozenset({"+", "-", "*", "/", "^", "neg"})


@dataclass(frozen=True, slots=True)
class Node:
    """`kind` is number, name, call, own (a call of a function of contin's grammar), neg, not, if (condition, then,
    else), sum (from, to, term), or an operator (+ - * / ^, a comparison, and, or); `text` spells numbers, names and the
    function that is called."""

    kind: str
    args: tuple[Node, ...] = ()
    text: str = ""
    bracketed: bool = False  # it stood in parentheses


def number(value: float | int | str) -> Node:
    """The node of a number, as a sign and a literal where it is negative."""
    text = value if isinstance(value, str) else repr(value)
    return Node("neg", (Node("number", text=text[1:]),)) if text.startswith("-") else Node("number", text=text)


def name(text: str) -> Node:
    """The node of a name."""
    return Node("name", text=text)


def call(function: str, *args: Node) -> Node:
    """function(args)."""
    return Node("call", args, function)


def own(function: str, *args: Node) -> Node:
    """function(args) of contin's grammar, whatever the name means in the other language."""
    return Node("own", args, function)


def either(condition: Node, then: Node, otherwise: Node) -> Node:
    """then if condition else otherwise."""
    return Node("if", (condition, then, otherwise))


def total(terms: list[Node]) -> Node:
    """The sum of terms; 0 of none."""
    if not terms:
        return number(0)
    node = terms[0]
    for term in terms[1:]:
        node = Node("+", (node, term))
    return node


def walk(node: Node) -> Iterator[Node]:
    """The node and everything below it."""
    waiting = [node]
    while waiting:
        node = waiting.pop()
        yield node
        waiting.extend(node.args)


def rebuilt(node: Node, change: Callable[[Node], Node | None]) -> Node:
    """The tree with `change(node)` in the place of every node for which that is not None; long chains of operators
    do not deepen the recursion."""
    spine: list[Node] = []
    while True:
        found = change(node)
        if found is not None:
            break
        if len(node.args) == 2 and node.kind in ("+", "-", "*", "/"):
            spine.append(node)
            node = node.args[0]
            continue
        args = tuple(rebuilt(arg, change) for arg in node.args)
        found = Node(node.kind, args, node.text, node.bracketed) if args else node
        break
    for parent in reversed(spine):
        found = Node(parent.kind, (found, rebuilt(parent.args[1], change)), parent.text, parent.bracketed)
    return found


def substituted(node: Node, values: Mapping[str, Node]) -> Node:
    """Names exchanged for other trees."""
    return rebuilt(node, lambda n: values.get(n.text) if n.kind == "name" else None)
