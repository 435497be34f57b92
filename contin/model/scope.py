"""What the names in a formula stand for: the scope a parser reads against, and the functions a model declares."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from contin.errors import ExpressionError
from contin.model.expression import Expression, postorder, substitute, symbol

NODE_BUDGET: Final = 500_000  # nodes that reading one model may build

Calls: TypeAlias = Callable[[Sequence[Expression], int], Expression | None]
"""From arguments and the position of a call to what stands for it; None where the call has its usual meaning."""


class Budget:
    """Counts the work of reading one model, so that formulas that grow exponentially end with a message."""

    def __init__(self) -> None:
        self.nodes = self.left = NODE_BUDGET

    def spend(self, nodes: int, position: int) -> None:
        self.left -= nodes
        if self.left < 0:
            message = f"the formulas grow beyond {self.nodes} operations when functions are inserted"
            raise ExpressionError(message, position)


@dataclass(frozen=True)
class Function:
    """A declared function; `body` holds `placeholders` where its arguments go, `text` is the body as it was written."""

    name: str
    parameters: tuple[str, ...]
    text: str
    body: Expression
    condition: bool = False
    size: int = 0

    @classmethod
    def make(cls, name: str, parameters: tuple[str, ...], text: str, body: Expression, condition: bool) -> Function:
        return cls(name, parameters, text, body, condition, len(postorder([body])))

    @property
    def heading(self) -> str:
        """g(u, v)"""
        return f"{self.name}({', '.join(self.parameters)})"

    def __call__(self, *arguments: Expression) -> Expression:
        """The body with all arguments put in at once."""
        slots = placeholders(self.name, self.parameters)
        return substitute([self.body], dict(zip(slots, arguments, strict=True)))[0]


def placeholders(function: str, parameters: tuple[str, ...]) -> tuple[Expression, ...]:
    """Symbols no formula can contain, so that an argument is never mistaken for a state of the same name."""
    return tuple(symbol(f"{function}:{parameter}") for parameter in parameters)


@dataclass(frozen=True)
class Scope:
    """Names a formula may use: what each stands for, which stand for conditions, the declared functions, and what to
    say (`unavailable`) about names that exist but mean nothing here. Without `names`, every name is a symbol.
    `calls` are names with a meaning of their own before parentheses, such as a state's value at an end."""

    names: Mapping[str, Expression] | None = None
    functions: Mapping[str, Function] = field(default_factory=dict)
    conditions: Collection[str] = frozenset()
    unavailable: Mapping[str, str] = field(default_factory=dict)
    budget: Budget = field(default_factory=Budget)
    calls: Mapping[str, Calls] = field(default_factory=dict)
