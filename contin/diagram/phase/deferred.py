"""Special points whose curves wait until those of the others are followed, and which of them come first."""

from __future__ import annotations

from dataclasses import dataclass, field

from contin.continuation.branch import SpecialPoint


@dataclass(eq=False)
class Deferred:
    """Points that wait, the youngest generation last; `used` of `most` points of curves were spent on them."""

    most: int
    used: int = 0
    waiting: list[tuple[int, SpecialPoint]] = field(default_factory=list)

    def add(self, generation: int, point: SpecialPoint) -> None:
        self.waiting.append((generation, point))

    def next(self) -> SpecialPoint | None:
        """The next one of the oldest generation; None where none is left, or the budget is spent."""
        if self.is_spent or not self.waiting:
            return None
        first = min(range(len(self.waiting)), key=lambda k: (self.waiting[k][0], k))
        return self.waiting.pop(first)[1]

    @property
    def is_spent(self) -> bool:
        return self.used >= self.most
