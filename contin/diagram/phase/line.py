"""A line across the box: every branch of states on it, with one parameter free and the other one held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from contin.continuation.branch import Branch
from contin.continuation.seed import Seed
from contin.diagram.diagram import Diagram
from contin.diagram.explore import Budget, Explorer

MORE: Final = Budget(branches=1, steps=300)
STATES: Final = ("equilibrium", "fixed-point", "orbit")


@dataclass(eq=False)
class Line:
    """What the explorer found along one line; `add` follows further states that it did not lead to."""

    axis: int
    value: float  # of the other parameter
    explorer: Explorer
    diagram: Diagram
    added: int = field(default=0)

    @property
    def branches(self) -> list[Branch]:
        return [b for b in self.diagram.branches if b.kind in STATES]

    @property
    def orbits(self) -> list[Branch]:
        """The families of orbits that were computed."""
        return [b for b in self.diagram.branches if b.kind == "orbit" and b.image_of is None]

    def add(self, seeds: Sequence[Seed]) -> None:
        """Follow states that are known to be there, with something left of the budget for each."""
        for seed in seeds:
            self.added += 1
            used = [b for b in self.diagram.branches if b.image_of is None]
            budget = replace(
                self.explorer.budget,
                branches=max(self.explorer.budget.branches, len(used) + MORE.branches),
                steps=max(self.explorer.budget.steps, sum(b.steps for b in used) + MORE.steps),
            )
            replace(self.explorer, budget=budget).add(self.diagram, f"more{self.added}", seed)
            self.raise_if_stopped()

    def raise_if_stopped(self) -> None:
        """Raise KeyboardInterrupt after Ctrl-C, which the explorer only notes."""
        if self.diagram.stopped:
            raise KeyboardInterrupt
