"""A journal of chunks, so that a killed run goes on where it was.

Everything that the engine does after a march (labels, ends, the next start) follows from the chunk alone. So a run is
resumed by running it again with the recorded chunks in place of the marches, until they are used up: the result is that
of a run that was never interrupted, and only the chunk in flight is computed twice.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from contin.continuation.problem import Chunk

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


def journaled(march: Callable[..., Chunk], journal: Journal, key: str) -> Callable[..., Chunk]:
    """`march` that answers from the journal first and records what it computes."""
    number = 0

    def marching(*arguments: Any) -> Chunk:
        nonlocal number
        chunk = journal.replay(key, number)
        if chunk is None:
            chunk = march(*arguments)
            journal.record(key, number, chunk)
        number += 1
        return chunk

    return marching
