r"""The text of an .ode file -> its statements: continued lines joined, comments dropped, arrays written out.

XPP's arrays are text: x[1..3]'=-x[j] is three lines, x1'=-x1 and so on, and %[1..3] ... % repeats whole blocks line
by line. `[j]`, `[j+2]`, `[j-1]` and `[j*2]` become numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError

MOST_STATEMENTS: Final = 100_000
_RANGE: Final = re.compile(r"\[\s*(\d+)\s*\.\.\s*(\d+)\s*\]")
_INDEX: Final = re.compile(r"([\w.]?)\[\s*[jJ]\s*(?:([-+*])\s*(\d+)\s*)?\]")
_FIXED: Final = re.compile(r"(?<=[\w.])\[\s*(\d+)\s*\]")  # x[3] is x3
_BLOCK: Final = re.compile(r"%\s*\[\s*(\d+)\s*\.\.\s*(\d+)\s*\]")
_UNCLOSED: Final = re.compile(r"\[\s*[jJ]\s*(?:[-+*]\s*\d+)?\s*$")
_COMMENT: Final = re.compile(r"\s#.*$")
INTEGRAL: Final = re.compile(r"\bint\s*[\[{]", re.IGNORECASE)


@dataclass(frozen=True)
class Line:
    """A statement and the line of the file it stands on."""

    number: int
    text: str


def statements(text: str, notes: list[str]) -> list[Line]:
    """The statements up to `done`, arrays written out; what was mended is added to `notes`."""
    found: list[Line] = []
    for line in _blocks(_joined(text, notes)):
        found.append(line)
        if len(found) > MOST_STATEMENTS:
            raise InputError(f"line {line.number}: more than {MOST_STATEMENTS} statements")
    return found


def _joined(text: str, notes: list[str]) -> Iterator[Line]:
    """Logical lines without comments."""
    rows = text.splitlines()
    i = 0
    while i < len(rows):
        start, row = i + 1, rows[i].strip()
        i += 1
        while row.endswith("\\") and i < len(rows):
            row = row[:-1] + rows[i].strip()
            i += 1
        row = row.rstrip("\\").replace("\t", " ")
        if row.startswith(('"', "#")) or not row:
            continue
        if not INTEGRAL.search(row):  # there # is a convolution
            row = _COMMENT.sub("", row)
        if re.fullmatch(r"[dD]\w*", row):  # done, d, ...: XPP reads the first letter
            return
        open_index = _UNCLOSED.search(row)
        if open_index is not None:
            notes.append(f"line {start}: {open_index[0]!r} is never closed; it is read as {open_index[0] + ']'!r}")
            row += "]"
        yield Line(start, row)


def _blocks(lines: Iterator[Line]) -> Iterator[Line]:
    """Blocks %[a..b] ... % and arrays [a..b] written out."""
    for line in lines:
        block = _BLOCK.match(line.text)
        if block is None:
            if not line.text.startswith("%"):
                yield from _array(line)
            continue
        body: list[Line] = []
        for inner in lines:
            if inner.text.startswith("%"):
                break
            body.append(inner)
        for j in _indices(block, line.number):
            for inner in body:
                yield Line(inner.number, _at(inner, j))


def _array(line: Line) -> Iterator[Line]:
    line = Line(line.number, _FIXED.sub(r"\1", line.text))
    found = _RANGE.search(line.text)
    if found is None:
        yield line
        return
    for j in _indices(found, line.number):
        yield Line(line.number, _at(Line(line.number, line.text.replace(found[0], f"{j}")), j))


def _indices(found: re.Match[str], number: int) -> range:
    first, last = int(found[1]), int(found[2])
    if abs(last - first) >= MOST_STATEMENTS:
        raise InputError(f"line {number}: an array of {abs(last - first) + 1} entries; {MOST_STATEMENTS} are allowed")
    return range(first, last + 1) if first <= last else range(first, last - 1, -1)


def _at(line: Line, j: int) -> str:
    """The line with [j] and what is made of it as numbers; as part of a name they cannot be negative."""

    def value(found: re.Match[str]) -> str:
        before, operator, operand = found[1], found[2], int(found[3] or 0)
        k = {None: j, "+": j + operand, "-": j - operand, "*": j * operand}[operator]
        if k < 0 and before:
            raise InputError(f"line {line.number}: at j = {j} the index {found[0][len(before) :]} is {k}")
        return f"{before}{k}" if k >= 0 else f"{before}({k})"

    return _INDEX.sub(value, line.text)
