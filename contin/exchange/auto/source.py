"""Fortran's free form: statements of a file's subroutines, and formulas of the assignments."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

from contin.exchange.formulas.parser import Binary, Dialect, FormulaError, Prefix, parse
from contin.exchange.formulas.tree import Node, number, rebuilt

_WORDS: Final = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
DIALECT: Final = Dialect(
    tokens=re.compile(
        r"(?P<space>\s+)|(?P<op>\*\*|==|/=|<=|>=|\.(?:eq|ne|lt|le|gt|ge|and|or|not)\.|[-+*/<>(),])"
        r"|(?P<number>(?:\d+\.(?!(?:eq|ne|lt|le|gt|ge|and|or)\.)\d*|\d+|\.\d+)(?:[eEdD][+-]?\d+)?)"
        r"|(?P<name>[A-Za-z_]\w*)",
        re.ASCII | re.IGNORECASE,
    ),
    binary={
        ".or.": Binary(1, "or"),
        ".and.": Binary(2, "and"),
        **{op: Binary(4, {"/=": "!="}.get(op, op)) for op in ("==", "/=", "<", "<=", ">", ">=")},
        **{f".{word}.": Binary(4, op) for word, op in _WORDS.items()},
        **{op: Binary(5, op) for op in "+-"},
        **{op: Binary(6, op) for op in "*/"},
        "**": Binary(7, "^", right=True),
    },
    prefix={"-": Prefix(6, "neg"), "+": Prefix(6, ""), ".not.": Prefix(4, "not")},
)
_HEAD: Final = re.compile(r"(?:recursive\s+)?subroutine\s+(\w+)\s*(?:\(([^)]*)\))?", re.IGNORECASE)
_END: Final = re.compile(r"end(?:\s*subroutine(?:\s+\w+)?)?", re.IGNORECASE)


@dataclass(frozen=True)
class Row:
    """A statement and the line it begins on."""

    line: int
    text: str


@dataclass(frozen=True)
class Subroutine:
    """A subroutine: its arguments in small letters, and its statements."""

    arguments: tuple[str, ...]
    rows: tuple[Row, ...]


def subroutines(text: str) -> dict[str, Subroutine]:
    """The subroutines of a file by their names in small letters."""
    found: dict[str, Subroutine] = {}
    head: re.Match[str] | None = None
    rows: list[Row] = []
    for row in _rows(text):
        start = _HEAD.fullmatch(row.text)
        if start is not None:
            head, rows = start, []
        elif head is not None and _END.fullmatch(row.text):
            arguments = tuple(a.strip().lower() for a in (head[2] or "").split(",") if a.strip())
            found[head[1].lower()] = Subroutine(arguments, tuple(rows))
            head = None
        else:
            rows.append(row)
    return found


def _rows(text: str) -> Iterator[Row]:
    """Statements without comments, continued lines joined."""
    waiting, first = "", 0
    for number_, line in enumerate(text.splitlines(), 1):
        bare = line.partition("!")[0].strip()
        if not bare:
            continue
        first = first if waiting else number_
        bare = bare.removeprefix("&") if waiting else bare
        if bare.endswith("&"):
            waiting += bare[:-1] + " "
            continue
        yield from (Row(first, part.strip()) for part in (waiting + bare).split(";") if part.strip())
        waiting = ""


def formula(text: str, literals: list[str], line: int) -> Node:
    """The tree of a formula: divisions of integers carried out as Fortran does, numbers in contin's spelling; those
    that single precision does not hold are added to `literals`."""
    node = rebuilt(parse(text, DIALECT), _carried_out)
    return rebuilt(node, lambda n: _literal(n, literals, line) if n.kind == "number" else None)


def _carried_out(node: Node) -> Node | None:
    """A quotient of integers is an integer."""
    if node.kind != "/" or not all(_is_integer(arg) for arg in node.args):
        return None
    top, bottom = (_integer(arg) for arg in node.args)
    if bottom == 0:
        raise FormulaError("a division of integers by 0")
    size = abs(top) // abs(bottom)
    return replace(number(size if (top < 0) == (bottom < 0) else -size), bracketed=True)


def _is_integer(node: Node) -> bool:
    if node.kind == "number":
        return node.text.isdigit()
    return node.kind in ("+", "-", "*", "/", "neg") and all(_is_integer(arg) for arg in node.args)


def _integer(node: Node) -> int:
    if node.kind == "number":
        return int(node.text)
    values = [_integer(arg) for arg in node.args]
    if node.kind == "neg":
        return -values[0]
    if node.kind == "/":
        return _integer(_carried_out(node) or node)
    a, b = values
    return {"+": a + b, "-": a - b, "*": a * b}[node.kind]


def _literal(node: Node, literals: list[str], line: int) -> Node:
    text = node.text.lower()
    if "d" in text:
        return replace(node, text=text.replace("d", "e"))
    if not text.isdigit() and _rounded(text):
        literals.append(f"{text} on line {line}")
    return replace(node, text=text)


def _rounded(text: str) -> bool:
    """True where single precision does not hold the number: more than 24 bits."""
    top, bottom = float(text).as_integer_ratio()
    return bottom.bit_length() > 1 and (top.bit_length() > 24 or bottom > 2**149)
