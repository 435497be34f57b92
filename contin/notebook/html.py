"""Small pieces of HTML. Every text that is not ours is escaped."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_ROWS: Final = 200  # of a table; what is left out is said
_CELL: Final = "padding:2px 10px;text-align:left;white-space:nowrap"


def text(words: object) -> str:
    """Any text, escaped."""
    return html.escape(str(words))


def paragraph(words: str) -> str:
    """A line of plain text."""
    return f"<div>{text(words)}</div>"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table with these headings."""
    rows = list(rows)
    if not rows:
        return ""
    top = "".join(f'<th style="{_CELL}">{text(name)}</th>' for name in head)
    body = "".join(
        "<tr>" + "".join(f'<td style="{_CELL}">{text(shown(cell))}</td>' for cell in row) + "</tr>"
        for row in rows[:MOST_ROWS]
    )
    more = paragraph(f"and {len(rows) - MOST_ROWS} more") if len(rows) > MOST_ROWS else ""
    return f'<table style="border-collapse:collapse"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>{more}'


def shown(cell: object) -> str:
    """A number with twelve digits, everything else as it is."""
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)


def details(summary: str, inside: str) -> str:
    """Folded until it is clicked; nothing where there is nothing inside."""
    return f"<details><summary>{text(summary)}</summary>{inside}</details>" if inside else ""


def notes(lines: Sequence[str]) -> str:
    """Notes as a list, always in sight."""
    return "<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines) + "</ul>" if lines else ""


def values(named: Mapping[str, object]) -> str:
    """A table of names and values."""
    return table(("name", "value"), named.items())


def image(figure: Figure, words: str) -> str:
    """A figure inside the page."""
    from contin.plot.picture import image_tag

    return image_tag(figure, text(words))
