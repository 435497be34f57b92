"""Walks over graphs of formulas, whatever their nodes are, without recursion: depth is no limit."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

Node = TypeVar("Node", bound=Hashable)
Made = TypeVar("Made")


def from_operands(
    root: Node, operands: Callable[[Node], Sequence[Node]], make: Callable[[Node, tuple[Made, ...]], Made]
) -> Made:
    """make(root, what was made of its operands), every node once."""
    done: dict[Node, Made] = {}
    stack = [root]
    while stack:
        node = stack[-1]
        if node in done:
            stack.pop()
            continue
        parts = operands(node)
        waiting = [part for part in parts if part not in done]
        if waiting:
            stack.extend(waiting)
            continue
        stack.pop()
        done[node] = make(node, tuple(done[part] for part in parts))
    return done[root]
