"""Assignments of a straight Fortran program."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from contin.exchange.assignments import element
from contin.exchange.auto.source import Row, Subroutine, formula
from contin.exchange.formulas.contin_text import Call, Writer
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node, substituted

_DECLARED: Final = re.compile(
    r"(implicit|integer|real|double\s*precision|logical|character|intent|dimension|save|external|use)\b.*",
    re.IGNORECASE | re.DOTALL,
)
_ASSIGNED: Final = re.compile(r"(\w+)\s*(\([^()]*(?:\([^()]*\)[^()]*)*\))?\s*=(?!=)(.*)", re.DOTALL)
_JACOBIAN: Final = re.compile(r"if\s*\(\s*ijac\b.*", re.IGNORECASE | re.DOTALL)
_CONTROL: Final = re.compile(
    r"(if|do|else|endif|end|call|select|case|where|goto|go|while|forall|allocate)\b", re.IGNORECASE
)
_SECTION: Final = re.compile(r"(\w+)\s*(\(\s*(\d*)\s*:\s*(\w*)\s*\))?\s*=\s*(.*)", re.DOTALL)
_LIST: Final = re.compile(r"\(/(.*)/\)|\[(.*)\]", re.DOTALL)


@dataclass(frozen=True)
class Assigned:
    """variable = node, array(index) = node, or the statement function variable(arguments) = node."""

    line: int
    variable: str
    index: int | None
    node: Node
    arguments: tuple[str, ...] = ()


def assigned(routine: Subroutine, notes: list[str]) -> list[Assigned]:
    """The assignments of a subroutine up to its Jacobian."""
    found: list[Assigned] = []
    literals: list[str] = []
    for row in routine.rows:
        if _JACOBIAN.fullmatch(row.text) or row.text.lower() == "return":
            break
        declared = _DECLARED.fullmatch(row.text)
        texts = [row.text]
        if declared is not None:
            _, colons, after = row.text.partition("::")
            texts = [part for part in _parts(after) if "=" in part] if colons else []
        elif re.match(r"parameter\s*\(", row.text, re.IGNORECASE):
            texts = _parts(row.text.partition("(")[2].rpartition(")")[0])
        for text in (single for several in texts for single in _elements(several)):
            item = _one(Row(row.line, text), literals, routine.arguments)
            if item.variable not in ("dfdu", "dfdp"):
                found.append(item)
    if literals:
        shown = ", ".join(literals[:3]) + (", ..." if literals[3:] else "")
        notes.append(f"numbers without D0, which Fortran rounds to single precision, are read as written: {shown}")
    return found


def _elements(text: str) -> list[str]:
    """PAR(2:3) = (/ a, b /) as an assignment for each element."""
    found = _SECTION.fullmatch(text)
    listed = None if found is None else _LIST.fullmatch(found[5].strip())
    if found is None or (found[2] is None and listed is None):
        return [text]
    first = int(found[3] or 1)
    if listed is not None:
        values = _parts(listed[1] if listed[1] is not None else listed[2])
    elif found[4].isdigit():
        values = [found[5]] * (int(found[4]) - first + 1)
    else:
        return [text]
    return [f"{found[1]}({first + k}) = {value}" for k, value in enumerate(values)]


def _one(row: Row, literals: list[str], arrays: tuple[str, ...]) -> Assigned:
    found = _ASSIGNED.fullmatch(row.text)
    if found is None or (_CONTROL.match(row.text) and not re.match(r"\w+\s*=(?!=)", row.text)):
        word = re.split(r"\W", row.text, maxsplit=1)[0] or row.text[:20]
        raise FormulaError(f"line {row.line}: {word!r}: only assignments are read (no IF, DO, CALL)")
    variable, index = found[1].lower(), found[2]
    if variable in ("dfdu", "dfdp"):
        return Assigned(row.line, variable, None, Node("number", text="0"))
    try:
        node = formula(found[3], literals, row.line)
        place = None if index is None else element(formula(variable + index, [], row.line))
    except FormulaError as error:
        raise FormulaError(f"line {row.line}: {error}") from None
    if index is None or place is not None:
        return Assigned(row.line, variable, place, node)
    arguments = tuple(a.strip().lower() for a in index[1:-1].split(","))
    if variable in arrays or not all(a.isidentifier() for a in arguments):
        raise FormulaError(f"line {row.line}: {variable}{index} = ...: the index is not a number")
    return Assigned(row.line, variable, None, node, arguments)


def inserted(item: Assigned) -> Call:
    """A statement function: its formula with the arguments of a call, and the present values of other variables."""

    def call(writer: Writer, node: Node) -> Node:
        if len(node.args) != len(item.arguments):
            raise FormulaError(f"{item.variable} takes {len(item.arguments)} arguments, got {len(node.args)}")
        return substituted(item.node, dict(zip(item.arguments, node.args, strict=True)))

    return call


def _parts(text: str) -> list[str]:
    """Parts between commas outside of parentheses."""
    depth, found = 0, [""]
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return [part.strip() for part in found]
