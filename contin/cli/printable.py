"""What comes from files reaches the terminal as characters only: no sequence in a name or a title steers it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from contin.records import Json

if TYPE_CHECKING:
    from collections.abc import Iterator


def printable(text: str) -> str:
    """Characters that are no part of a line of text (escape, bell, reversals of direction) as question marks."""
    return "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)


class _Printed:
    """What rich would print, with its own styles but without control characters of the text."""

    def __init__(self, inner: object) -> None:
        self.inner = inner

    def __rich_console__(self, console: Any, options: Json) -> Iterator[Any]:
        from rich.segment import Segment

        for segment in console.render(self.inner, options):
            clean = segment.control or segment.text.isprintable()
            yield segment if clean else Segment(printable(segment.text), segment.style)


class _Hook:
    """A render hook of rich's consoles."""

    def process_renderables(self, renderables: list[object]) -> list[Any]:
        from rich.control import Control

        return [part if isinstance(part, Control) else _Printed(part) for part in renderables]


PRINTABLE: Final[Any] = _Hook()
