"""Where a piece of input came from, and messages that say so: `file:line:column: path: what is wrong`."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Union

from contin.errors import InputError, InputWarning

Path = tuple[Union[str, int], ...]  # ("parameters", "delta", "value")
MAX_SHOWN: Final = 20  # messages in one error
MAX_FOUND: Final = 200  # mistakes after which reading stops
_WIDTH: Final = 100  # characters of a source line in a message


@dataclass(frozen=True)
class Span:
    """Part of a text: offsets of its first character and after its last."""

    start: int
    end: int


class Source(ABC):
    """Turns the path of a value, and an offset inside its text, into a place the user can find."""

    @abstractmethod
    def locate(self, path: Path, key: bool, value: str | None, span: Span | None) -> tuple[tuple[int, int], str, str]:
        """(sort key, heading without the path, source lines with carets or an empty text).

        `key` asks for the key instead of the value; `span` is a part of the text `value` that stands there.
        """

    @abstractmethod
    def full_path(self, path: Path) -> Path:
        """The path from the top of the file."""


@dataclass(frozen=True)
class CallSource(Source):
    """Values passed from Python: `name` says which call."""

    name: str

    def locate(self, path: Path, key: bool, value: str | None, span: Span | None) -> tuple[tuple[int, int], str, str]:
        snippet = "" if value is None or span is None else carets("      ", value, span.start, span.end)
        return (0, 0), self.name, snippet

    def full_path(self, path: Path) -> Path:
        return path


@dataclass(frozen=True)
class Marks:
    """Places of one value in a YAML text; `key` is None for items of a list."""

    value: Span
    key: Span | None = None


@dataclass(frozen=True)
class YamlSource(Source):
    """A YAML text whose values have `marks`."""

    name: str
    text: str
    marks: Mapping[Path, Marks] = field(default_factory=dict)

    def locate(self, path: Path, key: bool, value: str | None, span: Span | None) -> tuple[tuple[int, int], str, str]:
        exact = path in self.marks
        while path and path not in self.marks:
            path = path[:-1]
        marks = self.marks.get(path)
        if marks is None:
            return (0, 0), self.name, ""
        place = marks.key if (key or not exact) and marks.key is not None else marks.value
        if exact and not key and value is not None and span is not None:
            place = _inside(self.text, marks.value, value, span)
        return self.at(place)

    def full_path(self, path: Path) -> Path:
        return path

    def at(self, place: Span) -> tuple[tuple[int, int], str, str]:
        """The same for a part of the file's text."""
        begin = self.text.rfind("\n", 0, place.start) + 1
        end = self.text.find("\n", place.start)
        line = self.text[begin : end if end >= 0 else len(self.text)]
        row, column = self.text.count("\n", 0, place.start) + 1, place.start - begin
        snippet = carets(f"{row:5d} | ", line, column, min(place.end - begin, len(line)))
        return (row, column), f"{self.name}:{row}:{column + 1}", snippet


@dataclass(frozen=True)
class PartSource(Source):
    """A part of another source: the value at `prefix`."""

    whole: Source
    prefix: Path

    def locate(self, path: Path, key: bool, value: str | None, span: Span | None) -> tuple[tuple[int, int], str, str]:
        return self.whole.locate(self.prefix + path, key, value, span)

    def full_path(self, path: Path) -> Path:
        return self.whole.full_path(self.prefix + path)


class Problems:
    """Collects what is wrong with one input, so that several mistakes are reported at once."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.found: list[tuple[tuple[int, int], int, str]] = []

    def add(
        self, path: Path, message: str, *, key: bool = False, value: str | None = None, span: Span | None = None
    ) -> None:
        """Note a mistake at `path`: at its key, its value, or the part `span` of the formula `value`."""
        order, heading, snippet = self.source.locate(path, key, value, span)
        shown = path_text(self.source.full_path(path))
        self.add_text(order, f"{heading}: {shown}: {message}" if shown else f"{heading}: {message}", snippet)

    def warn(self, path: Path, message: str) -> None:
        """Say something about the value at `path` that is no mistake: an `InputWarning`."""
        _, heading, _ = self.source.locate(path, False, None, None)
        text = f"{heading}: {path_text(self.source.full_path(path))}: {message}"
        warnings.warn(printable(text), InputWarning, stacklevel=2)

    def add_text(self, order: tuple[int, int], text: str, snippet: str) -> None:
        """Note a mistake whose message is complete; `order` is its line and column."""
        self.found.append((order, len(self.found), printable(text) + (f"\n{snippet}" if snippet else "")))
        if len(self.found) >= MAX_FOUND:
            self.raise_if_any()

    def __bool__(self) -> bool:
        return bool(self.found)

    def raise_if_any(self) -> None:
        """One InputError with everything found so far, in the order of the source."""
        if self.found:
            texts = list(dict.fromkeys(text for _, _, text in sorted(self.found)))
            if len(texts) > MAX_SHOWN:
                more = f"{'at least ' * (len(texts) >= MAX_FOUND)}{len(texts) - MAX_SHOWN} more"
                texts = [*texts[:MAX_SHOWN], f"... and {more}"]
            raise InputError("\n".join(texts))


def path_text(path: Path) -> str:
    """parameters.delta.value, expect[0].at"""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def printable(text: str) -> str:
    """Control characters, which could steer a terminal, as question marks."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)


def carets(margin: str, line: str, start: int, end: int) -> str:
    """A source line with carets under columns start to end; a long line is cut around them."""
    line = line.split("\n", 1)[0] if start <= line.find("\n") or "\n" not in line else line.replace("\n", " ")
    line = printable(line.replace("\t", " "))
    shift = max(0, start - _WIDTH // 2) if len(line) > _WIDTH else 0
    line = line[shift : shift + _WIDTH]
    start = min(start - shift, len(line))
    end = max(start + 1, min(end - shift, len(line)))
    pad = " " * (len(margin) - 2) + "| " if margin.endswith("| ") else margin
    return f"{margin}{line}\n{pad}{' ' * start}{'^' * (end - start)}"


def _inside(text: str, place: Span, value: str, span: Span) -> Span:
    """The place in the file of `span` in a scalar: characters other than white space correspond one to one, unless
    the scalar is written with escapes; then the whole scalar is meant."""
    written = text[place.start : place.end]
    offset = 0
    if written[:1] in ("|", ">"):
        offset = written.find("\n") + 1
    elif written[:1] in ("'", '"'):
        offset = 1
    solid = [i for i in range(offset, len(written)) if not written[i].isspace()]
    wanted = [c for c in value if not c.isspace()]
    if [written[i] for i in solid[: len(wanted)]] != wanted:
        return place
    first = sum(not c.isspace() for c in value[: span.start])
    if first >= len(wanted):
        last = solid[len(wanted) - 1] + 1 if wanted else offset
        return Span(place.start + last, place.start + last + 1)
    count = max(1, sum(not c.isspace() for c in value[span.start : span.end]))
    last = solid[min(first + count, len(wanted)) - 1]
    return Span(place.start + solid[first], place.start + last + 1)
