"""A line on each branch when it is whole: the journal of a run hears of it first."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contin.continuation.branch import Branch
    from contin.continuation.journal import Journal
    from contin.continuation.sample import Chunk


class Told:
    """A journal, or none, that also tells of each branch once."""

    def __init__(self, journal: Journal | None, tell: Callable[[Branch], object]) -> None:
        self._journal, self._tell = journal, tell
        self._names: set[str] = set()

    def replay(self, key: str, number: int) -> Chunk | None:
        """As the journal."""
        return None if self._journal is None else self._journal.replay(key, number)

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        """As the journal."""
        if self._journal is not None:
            self._journal.record(key, number, chunk)

    def finished(self, branch: Branch) -> None:
        """As the journal, then the line; a branch that is kept again has had it."""
        if self._journal is not None:
            self._journal.finished(branch)
        if branch.name not in self._names:
            self._names.add(branch.name)
            self._tell(branch)
