"""YAML 1.2 text -> plain data with the place of every value, without ever constructing an object a tag asks for.

Works on ruamel.yaml's event stream with an explicit stack: depth, size and alias expansion are budgets, duplicate keys
are mistakes, tags are refused. Scalars are resolved by the YAML 1.2 core schema: `1e-3` is a number, `on` is a text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Final, NoReturn

from contin.errors import InputError
from contin.limits import is_finite
from contin.model.source import Marks, Path, Problems, Span, YamlSource
from contin.model.yaml_lines import HELD, Entry, Shortened, shorten
from contin.records import Fields, Json

MAX_BYTES: Final = 20_000_000
MAX_DEPTH: Final = 40  # mappings and lists inside each other
MAX_VALUES: Final = 1_000_000  # values, counted once for every alias that repeats them

_INTEGER: Final = re.compile(r"[-+]?[0-9]+")
_FLOAT: Final = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_CONSTANTS: Final[Fields] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False,
}  # fmt: skip


@dataclass(frozen=True)
class Document:
    """`data` (dicts with text keys, lists, texts, numbers, booleans, None) and where it came from."""

    data: Json
    source: YamlSource


def read_file(path: FilePath | str) -> Document:
    """Read one YAML file.

    Raises
    ------
    InputError
        The file cannot be read, is larger than `MAX_BYTES`, is not UTF-8, or is not one YAML document.
    """
    file = FilePath(path)
    try:
        if file.is_dir():
            raise InputError(f"{path}: is a folder; name a file in it")
        with file.open("rb") as stream:
            raw = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a null byte in the path
        raise InputError(f"{str(path)!r}: cannot be read: {error}") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES // 1_000_000} MB")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = raw[: error.start].count(b"\n") + 1
        raise InputError(f"{path}:{row}: not UTF-8 text (byte {error.start}); save the file as UTF-8") from None
    return read_text(text, str(path))


def read_text(text: str, filename: str = "text") -> Document:
    """Read one YAML document from a text; `filename` is for messages."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > MAX_BYTES:
        raise InputError(f"{filename}: larger than {MAX_BYTES // 1_000_000} MB")
    short = shorten(text)
    if short is not None:
        try:
            return _read(_Reader(filename, text, short))
        except (_NotHeldError, InputError):
            pass  # a run that was no mapping, or a mistake: the parser tells about the text as it is
    return _read(_Reader(filename, text))


def _read(reader: _Reader) -> Document:
    data = reader.run()
    reader.problems.raise_if_any()
    return Document(data, reader.source)


class _NotHeldError(Exception):
    """A run of lines that was held back stands where it is no part of a mapping."""


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not come yet."""

    container: Fields | list[Json]
    path: Path
    span: Span
    key: str | None = None  # that waits for its value
    key_span: Span | None = None
    anchor: str | None = None
    first: dict[str, Span] = field(default_factory=dict)  # where each key stood first
    before: int = 0  # values read before it
    flow: bool = False


class _Reader:
    def __init__(self, filename: str, text: str, short: Shortened | None = None) -> None:
        self.short = short
        self.held: list[tuple[Entry, ...]] = []  # of the value that comes next
        self.marks: dict[Path, Marks] = {}
        self.source = YamlSource(filename, text, self.marks)
        self.problems = Problems(self.source)
        self.stack: list[_Open] = []
        self.anchors: dict[str, tuple[object, int]] = {}
        self.values = 0
        self.root: object = None
        self.documents = 0

    def run(self) -> Json:
        for event in self.events():
            kind = type(event).__name__
            start, end = event.start_mark.index, event.end_mark.index
            span = Span(start, end) if self.short is None else Span(self.short.at(start), self.short.at(end))
            if kind == "DocumentStartEvent":
                self.documents += 1
                if self.documents > 1:
                    self.fail(span, "a second YAML document; one file holds one")
            elif kind == "ScalarEvent":
                self.scalar(event, span)
            elif kind in ("MappingStartEvent", "SequenceStartEvent"):
                self.open(event, span, {} if kind == "MappingStartEvent" else [])
            elif kind in ("MappingEndEvent", "SequenceEndEvent"):
                self.close()
            elif kind == "AliasEvent":
                self.alias(event.anchor, span)
        return self.root

    def events(self) -> Iterator[Json]:
        """The parser's events; everything it may raise becomes one InputError with a place."""
        from ruamel.yaml import YAML
        from ruamel.yaml.error import MarkedYAMLError

        try:
            yield from YAML(typ="safe", pure=True).parse(self.short.text if self.short else self.source.text)
        except (InputError, _NotHeldError):
            raise
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            what = error.problem or error.context or "not YAML"
            self.fail(Span(mark.index, mark.index + 1) if mark else None, f"not valid YAML: {what}{_hint(what)}")
        except Exception as error:  # noqa: BLE001  the parser fails in many ways on broken text
            self.fail(None, f"not valid YAML: {str(error).splitlines()[0] if str(error) else type(error).__name__}")

    def fail(self, span: Span | None, message: str) -> NoReturn:
        heading, snippet = self.source.name, ""
        if span is not None:
            _, heading, snippet = self.source.at(span)
        self.problems.raise_if_any()
        raise InputError(f"{heading}: {message}" + (f"\n{snippet}" if snippet else ""))

    def scalar(self, event: Json, span: Span) -> None:
        if event.tag is not None:
            self.fail(span, f"the tag {event.tag} is not allowed; write the plain value")
        if self.short is not None and self.is_held(event):
            return
        plain = event.style in (None, "")
        written = self.source.text[span.start : span.end]
        trimmed = Span(span.start, span.start + len(written.rstrip())) if plain else span
        if plain and not written and self.stack and self.stack[-1].key_span is not None:
            trimmed = self.stack[-1].key_span  # nothing is written: show the key
        if self.expects_key():
            self.take_key(event.value, trimmed)
            if event.anchor:
                self.anchors[event.anchor] = (event.value, 1)
            return
        self.count(1, span)
        value = _resolve(event.value) if plain else self.whole_characters(event.value, span)
        if event.anchor:
            self.anchors[event.anchor] = (value, 1)
        self.put(value, trimmed)

    def is_held(self, event: Json) -> bool:
        """True for key and value of the line that stands for a run of lines, whose entries are taken in then."""
        if self.held:
            for entry in self.held.pop():
                key, value = len(entry.key), len(entry.value)
                self.count(1, Span(entry.value_at, entry.value_at + value))
                self.take_key(entry.key, Span(entry.key_at, entry.key_at + key))
                self.put(_resolve(entry.value), Span(entry.value_at, entry.value_at + value))
            return True
        if HELD not in event.value:
            return False
        number = event.value.removeprefix(HELD)
        if not self.expects_key() or event.style not in (None, "") or not number.isdecimal() or self.stack[-1].flow:
            raise _NotHeldError
        assert self.short is not None
        self.held.append(self.short.runs[int(number)])
        return True

    def whole_characters(self, value: str, span: Span) -> str:
        """JSON writes characters beyond 16 bits as two escapes; put the halves together."""
        if not any("\ud800" <= c <= "\udfff" for c in value):
            return value
        try:
            return value.encode("utf-16", "surrogatepass").decode("utf-16")
        except UnicodeDecodeError:
            self.fail(span, "half of a character: a \\u escape between \\ud800 and \\udfff without its partner")

    def open(self, event: Json, span: Span, container: Fields | list[object]) -> None:
        if event.tag is not None:
            self.fail(span, f"the tag {event.tag} is not allowed; write the plain value")
        if self.expects_key():
            self.fail(span, "a key must be a name, not a mapping or a list")
        if len(self.stack) >= MAX_DEPTH:
            self.fail(span, f"nested deeper than {MAX_DEPTH} levels")
        self.count(1, span)
        path = self.put(container, span)
        self.stack.append(
            _Open(container, path, span, anchor=event.anchor, before=self.values, flow=bool(event.flow_style))
        )

    def close(self) -> None:
        done = self.stack.pop()
        if done.anchor:
            self.anchors[done.anchor] = (done.container, 1 + self.values - done.before)

    def alias(self, anchor: str, span: Span) -> None:
        if anchor not in self.anchors:
            self.fail(span, f"*{anchor} repeats a value that is not complete; write it out")
        value, size = self.anchors[anchor]
        if self.expects_key():
            if not isinstance(value, str):
                self.fail(span, "a key must be a name")
            self.take_key(value, span)
            return
        self.count(size, span)
        self.put(value, span)

    def expects_key(self) -> bool:
        return bool(self.stack) and isinstance(self.stack[-1].container, dict) and self.stack[-1].key is None

    def take_key(self, key: str, span: Span) -> None:
        top = self.stack[-1]
        if key in top.first:
            row = self.source.at(top.first[key])[0][0]
            self.marks.setdefault((*top.path, key), Marks(span, span))
            order, heading, snippet = self.source.at(span)
            message = f"{heading}: the key {key!r} is already on line {row}; remove one of them"
            self.problems.add_text(order, message, snippet)
        top.first.setdefault(key, span)
        top.key, top.key_span = key, span

    def put(self, value: object, span: Span) -> Path:
        """Hang a value into the open container; its path."""
        if not self.stack:
            self.root = value
            self.marks[()] = Marks(span)
            return ()
        top = self.stack[-1]
        part: str | int
        if isinstance(top.container, dict):
            part = str(top.key)
            top.container[part] = value
            top.key = None
        else:
            part = len(top.container)
            top.container.append(value)
        path = (*top.path, part)
        self.marks[path] = Marks(span, top.key_span)
        top.key_span = None
        return path

    def count(self, values: int, span: Span) -> None:
        self.values += values
        if self.values > MAX_VALUES:
            self.fail(span, f"more than {MAX_VALUES} values, aliases written out")


def _resolve(text: str) -> Json:
    """A plain scalar by the YAML 1.2 core schema; what is no constant and no number stays a text."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if len(text) < 400:
        if _INTEGER.fullmatch(text):
            whole = int(text)
            return whole if is_finite(whole) else text
        if _FLOAT.fullmatch(text):
            value = float(text)
            return value if abs(value) != float("inf") else text
    return text


def _hint(problem: str) -> str:
    if "mapping values are not allowed" in problem:
        return " (a formula with ': ' in it needs quotes; a list needs '- ' or [ ])"
    if "cannot start any token" in problem:
        return " (a text that starts with a special character needs quotes)"
    if "could not find expected ':'" in problem:
        return " (is a colon, or a space after it, missing here?)"
    return ""
