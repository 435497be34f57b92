"""What the user of a phase diagram should know, each once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

from contin.continuation.defects import noted


@dataclass(eq=False)
class Notes:
    """Sentences in the order in which they were first said."""

    texts: list[str] = field(default_factory=list)

    def __iter__(self) -> Iterator[str]:
        return iter(self.texts)

    def add(self, text: str) -> None:
        if text not in self.texts:
            self.texts.append(text)

    def extend(self, texts: Iterable[str]) -> None:
        for text in texts:
            self.add(text)

    def surviving(self, what: str) -> AbstractContextManager[None]:
        """An error inside costs only what is inside, and is noted."""
        return noted(lambda text: self.add(f"{what}: {text}"))
