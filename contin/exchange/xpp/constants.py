"""Values that XPP knows when it reads a file: numbers of declarations, limits of sums, indices of shifts."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Final

from contin.exchange.formulas.tree import Node

_LEADING: Final = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


def leading_number(text: str) -> tuple[float, bool]:
    """The number a text begins with, 0 where there is none, as XPP reads values; and whether that is all of it."""
    found = _LEADING.match(text)
    if found is None:
        return 0.0, not text.strip()
    value = float(found[0])
    return (value, not text[found.end() :].strip()) if math.isfinite(value) else (0.0, False)


def constant(node: Node, values: Mapping[str, float]) -> float | None:
    """The value of a tree of numbers, + - * / and names in `values`; None where it is none."""
    if node.kind == "number":
        return float(node.text)
    if node.kind == "name":
        return values.get(node.text)
    parts = [constant(arg, values) for arg in node.args]
    known = [part for part in parts if part is not None]
    if len(known) != len(parts):
        return None
    if node.kind == "neg":
        return -known[0]
    if node.kind == "call" and node.text == "flr":
        return float(math.floor(known[0]))
    if len(known) != 2:
        return None
    a, b = known
    if node.kind == "+":
        return a + b
    if node.kind == "-":
        return a - b
    if node.kind == "*":
        return a * b
    return a / b if node.kind == "/" and b else None


def folded(node: Node, values: Mapping[str, float]) -> Node:
    """The tree without the terms that vanish at `values`: a product with a factor that is zero there."""
    args = tuple(folded(arg, values) for arg in node.args)
    node = Node(node.kind, args, node.text)
    factors = args if node.kind == "*" else args[:1] if node.kind == "/" else ()
    if any(constant(factor, values) == 0.0 for factor in factors):
        return Node("number", text="0")
    if node.kind in ("+", "-") and constant(args[1], values) == 0.0:
        return args[0]
    if node.kind == "+" and constant(args[0], values) == 0.0:
        return args[1]
    return node
