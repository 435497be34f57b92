"""What the user of a phase diagram should know, each once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from contin.continuation.defects import contained, noted


@dataclass(eq=False)
class Notes:
    """Sentences in the order in which they were first said."""

    texts: list[str] = field(default_factory=list)
    of_defects: set[str] = field(default_factory=set)  # those that tell of errors which contin did not foresee

    heads: set[str] = field(default_factory=set)  # of those that are said for the first place only

    @property
    def defects(self) -> tuple[str, ...]:
        """In the order in which they were said."""
        return tuple(text for text in self.texts if text in self.of_defects)

    def __iter__(self) -> Iterator[str]:
        return iter(self.texts)

    def add(self, text: str) -> None:
        if text not in self.texts:
            self.texts.append(text)

    def add_first(self, head: str, rest: str) -> None:
        """The first one with this head; what further ones would say is the same elsewhere."""
        if head not in self.heads:
            self.heads.add(head)
            self.add(head + rest)

    def extend(self, texts: Iterable[str]) -> None:
        for text in texts:
            self.add(text)

    def defect(self, text: str) -> None:
        """Add what tells of an error that contin did not foresee."""
        self.of_defects.add(text)
        self.add(text)

    @contextmanager
    def surviving(self, what: str) -> Iterator[None]:
        """An error inside costs only what is inside, and is noted."""
        with noted(lambda text: self.add(f"{what}: {text}")), contained(lambda text: self.defect(f"{what}: {text}")):
            yield
