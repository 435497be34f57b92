"""A journal of chunks, so that a killed run goes on where it was.

Everything that the engine does after a march (labels, ends, the next start) follows from the chunk alone. So a run is
resumed by running it again with the recorded chunks in place of the marches, until they are used up: the result is that
of a run that was never interrupted, and only the chunk in flight is computed twice.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from contin.continuation.sample import Chunk

if TYPE_CHECKING:
    from contin.continuation.branch import Branch


class Journal(Protocol):
    """Where chunks are kept, by the key of an arm and their number in it, and branches, by their name."""

    def replay(self, key: str, number: int) -> Chunk | None:
        """A recorded chunk, or None where it has yet to be computed."""

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        """Keep a chunk that was just computed; when this returns, a killed process does not lose it."""

    def finished(self, branch: Branch) -> None:
        """Keep a branch that is whole, before the next one begins; again, where one of this name was kept."""


class OfSearch:
    """The journal of a search whose branches may have equal names: its arms are numbered in the order they begin.

    Only what the search calls `finished` on the journal itself is kept as a branch, not what it looks at on the way.
    """

    def __init__(self, journal: Journal, search: str) -> None:
        self._journal, self._search, self._begun = journal, search, 0
        self._keys: dict[str, str] = {}

    def replay(self, key: str, number: int) -> Chunk | None:
        """As the journal; number 0 is asked for once, when an arm begins."""
        if number == 0:
            self._begun += 1
            self._keys[key] = f"{self._search} {self._begun} {key}"
        return self._journal.replay(self._keys[key], number)

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        """As the journal."""
        self._journal.record(self._keys[key], number, chunk)

    def finished(self, branch: Branch) -> None:
        """A branch of the search is no result."""


def journaled(march: Callable[..., Chunk], journal: Journal, key: str) -> Callable[..., Chunk]:
    """`march` that answers from the journal first and records what it computes."""
    number = 0

    def marching(*arguments: object) -> Chunk:
        nonlocal number
        chunk = journal.replay(key, number)
        if chunk is None:
            chunk = march(*arguments)
            journal.record(key, number, chunk)
        number += 1
        return chunk

    return marching
