"""Long runs of plain `name: value` lines in a YAML text, found without a YAML parser: most of a large model.

A run becomes one line with a key that no file has (`HELD` and a number); the parser reads the shorter text, and the
reader puts the run's entries where it meets that key in a block mapping. Lines are taken only where every reading of
them is the same: `name: value` at one indentation, the value one plain scalar on the line. If the parser meets the key
anywhere else (a literal block, a flow mapping, a mistake), the text is read again as it is.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from typing import Final

HELD: Final = "\ue000"  # a character for private use
FEWEST: Final = 50  # lines worth holding back
_LINE: Final = re.compile(
    r"( +)([A-Za-z_][\w]*): ([A-Za-z0-9_(.][\w+\-*/^().,<> ]*[\w)]|[A-Za-z0-9_]|-[0-9.a-zA-Z_(][\w+\-*/^().,<> ]*)\n"
)


@dataclass(frozen=True)
class Entry:
    """One line: key and value with their places in the whole text."""

    key: str
    key_at: int
    value: str
    value_at: int


@dataclass(frozen=True)
class Shortened:
    """A text without its long runs, whose entries are `runs`; offsets in `text` become those in the whole by `at`."""

    text: str
    runs: tuple[tuple[Entry, ...], ...]
    starts: tuple[int, ...]  # offsets in `text` from which `shifts` hold
    shifts: tuple[int, ...]

    def at(self, offset: int) -> int:
        """The offset in the whole text."""
        k = bisect_right(self.starts, offset) - 1
        return offset + (self.shifts[k] if k >= 0 else 0)


def shorten(text: str) -> Shortened | None:
    """The text with its long runs held back; None where there are none."""
    if HELD in text or text.count("\n") < FEWEST:
        return None
    parts: list[str] = []
    runs: list[tuple[Entry, ...]] = []
    starts: list[int] = []
    shifts: list[int] = []
    copied = length = position = 0
    while position < len(text):
        run, last = _run(text, position)
        if len(run) >= FEWEST:
            run = run[1:-1]  # the first and the last stay: what stands around them reads them as before
            begin, end = run[0].key_at, run[-1].value_at + len(run[-1].value)
            parts.append(text[copied:begin])
            placeholder = f"{HELD}{len(runs)}: 0"
            length += begin - copied + len(placeholder)
            parts.append(placeholder)
            runs.append(tuple(run))
            starts.append(length)
            shifts.append(end - length)
            copied = end
        position = last if last > position else text.find("\n", position) + 1 or len(text)
    if not runs:
        return None
    parts.append(text[copied:])
    return Shortened("".join(parts), tuple(runs), tuple(starts), tuple(shifts))


def _run(text: str, position: int) -> tuple[list[Entry], int]:
    """Entries of consecutive lines from `position` on at one indentation, and where the next line begins."""
    entries: list[Entry] = []
    indent = None
    while True:
        match = _LINE.match(text, position)
        if match is None or (indent is not None and match[1] != indent):
            return entries, position
        indent = match[1]
        entries.append(Entry(match[2], match.start(2), match[3], match.start(3)))
        position = match.end()
