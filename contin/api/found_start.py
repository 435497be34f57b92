"""A solution that was looked for, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from contin.continuation.seed import Seed
from contin.continuation.told import Told

LONG: Final = 400  # characters of a solution in words


@dataclass(frozen=True, eq=False, repr=False)
class FoundStart(Told):
    """A solution, and how it was found: given, rest, cycle, newton or deflation, and in words."""

    solution: Any
    how: str
    words: str

    @property
    def system(self) -> Any:
        return self.solution.system

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""
        seed: Seed = self.solution.seed(parameter)
        return seed

    def __str__(self) -> str:
        text = str(self.solution)
        return f"{text if len(text) <= LONG else text[: LONG - 3] + '...'} ({self.words})"
