"""Trees of foreign formulas as text in contin's grammar.

There a comparison is no number and a number no condition: where a foreign language takes one for the other, c becomes
(1 if c else 0) and x becomes x != 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final, TypeAlias

from contin.exchange.formulas.tree import COMPARISONS, LOGICAL, Node
from contin.model.binding import AND, ATOM, COMPARE, NOT, OR, POWER, PRODUCT, SIGN, SUM, TERNARY

Call: TypeAlias = Callable[["Writer", Node], Node | str]
_LEVELS: Final = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT}


class Writer:
    """Writes trees. `name` gives the text of a name (which stands as it is); `calls` the tree, or the text, that a call
    becomes, by the function's name."""

    def __init__(self, name: Callable[[str], str], calls: Mapping[str, Call], otherwise: Call) -> None:
        self.name, self.calls, self.otherwise = name, calls, otherwise

    def number(self, node: Node, level: int = TERNARY) -> str:
        """The text of a number, in parentheses unless it binds at least as strongly as `level`."""
        text, found = self._number(node)
        return text if found >= level else f"({text})"

    def condition(self, node: Node, level: int = TERNARY) -> str:
        """The text of a condition."""
        text, found = self._condition(node)
        return text if found >= level else f"({text})"

    def call(self, function: str, *args: Node) -> str:
        """function(args) of contin's grammar."""
        return f"{function}({', '.join(self.number(a) for a in args)})"

    def _number(self, node: Node) -> tuple[str, int]:
        kind = node.kind
        if kind in _LEVELS:
            return self._chain(node)
        if kind == "number":
            return node.text, ATOM
        if kind == "name":
            return self.name(node.text), ATOM
        if kind == "neg":
            return f"-{self.number(node.args[0], SIGN)}", SIGN
        if kind == "^":
            return f"{self.number(node.args[0], ATOM)}^{self.number(node.args[1], SIGN)}", POWER
        if kind == "if":
            condition, then, otherwise = node.args
            parts = self.number(then, OR), self.condition(condition, OR), self.number(otherwise, OR)
            return f"({parts[0]} if {parts[1]} else {parts[2]})", ATOM
        if kind in COMPARISONS or kind in LOGICAL:
            return f"(1 if {self.condition(node, OR)} else 0)", ATOM
        if kind == "own":
            return self.call(node.text, *node.args), ATOM
        found = self.calls.get(node.text, self.otherwise)(self, node)
        return (found, ATOM) if isinstance(found, str) else self._number(found)

    def _chain(self, node: Node) -> tuple[str, int]:
        """a + b - c ..., a * b / c ...: as many operands as there are, without recursion."""
        rest: list[tuple[str, str]] = []
        level = _LEVELS[node.kind]
        whole = level
        while _LEVELS.get(node.kind) == level:
            left, right = node.args
            rest.append((f" {node.kind} " if level == SUM else node.kind, self.number(right, level + 1)))
            node = left
        text = self.number(node, level)
        return text + "".join(f"{op}{operand}" for op, operand in reversed(rest)), whole

    def _condition(self, node: Node) -> tuple[str, int]:
        kind = node.kind
        if kind in COMPARISONS:
            return f"{self.number(node.args[0], SUM)} {kind} {self.number(node.args[1], SUM)}", COMPARE
        if kind == "not":
            return f"not {self.condition(node.args[0], COMPARE)}", NOT
        if kind in LOGICAL:
            level = AND if kind == "and" else OR
            left, right = (self.condition(arg, level + 1) for arg in node.args)
            return f"{left} {kind} {right}", level
        return f"{self.number(node, SUM)} != 0", COMPARE
