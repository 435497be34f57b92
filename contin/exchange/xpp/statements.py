"""One statement of an .ode file: what it declares."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from contin.exchange.xpp.lines import Line

_NAME: Final = r"([A-Za-z_][\w.$@]*)"
_FORMS: Final = tuple(
    (kind, re.compile(pattern, re.DOTALL | re.ASCII))
    for kind, pattern in (
        ("derived", rf"!\s*{_NAME}\s*=(?!=)(.*)"),
        ("algebraic", r"(0)\s*=(?!=)(.*)"),
        ("equation", rf"{_NAME}\s*'\s*=(?!=)(.*)"),
        ("equation", rf"[dD]{_NAME}\s*/\s*[dD][tT]\s*=(?!=)(.*)"),
        ("map", rf"{_NAME}\s*\(\s*[tT]\s*\+\s*1\s*\)\s*=(?!=)(.*)"),
        ("initial value", rf"{_NAME}\s*\(\s*0\s*\)\s*=(?!=)(.*)"),
        ("function", rf"{_NAME}\s*(\([^()]*\)\s*=(?!=).*)"),
        ("fixed", rf"{_NAME}\s*=(?!=)(.*)"),
    )
)
_COMMAND: Final = re.compile(r"([A-Za-z_]+)\s+(.*)", re.DOTALL)
_VALUE: Final = re.compile(r"([A-Za-z_][\w.$@]*)(?:\s*=\s*([^\s,]+))?", re.ASCII)

# XPP reads the first letters of a command alone; longer ones first
COMMANDS: Final = {
    "sol": "solve",
    "spe": "special",
    "se": "set",
    "op": "options file",
    "on": "only",
    "a": "aux",
    "b": "boundary",
    "d": "done",
    "e": "export",
    "g": "global",
    "i": "initial",
    "m": "markov",
    "n": "number",
    "p": "parameter",
    "t": "table",
    "v": "volterra",
    "w": "wiener",
}
CHEMISTRY: Final = frozenset({"mksol", "addtosol", "tracksol", "phsol", "species"})  # XPP's pHtools


@dataclass(frozen=True)
class Statement:
    """`kind` as in `_FORMS` and `COMMANDS`, or options, chemistry, unknown; `name` is what is declared, `text` the
    rest, of a function with its arguments."""

    line: int
    kind: str
    name: str
    text: str


def statement(line: Line) -> Statement:
    """What one logical line declares."""
    text = line.text
    if text.startswith("@"):
        return Statement(line.number, "options", "", text[1:])
    for kind, form in _FORMS:
        found = form.fullmatch(text)
        if found is not None:
            return Statement(line.number, kind, found[1], found[2].strip())
    found = _COMMAND.fullmatch(text)
    word = (found[1] if found is not None else text).lower()
    rest = found[2] if found is not None else ""
    if word in CHEMISTRY:
        return Statement(line.number, "chemistry", word, rest)
    kind = next((COMMANDS[start] for start in COMMANDS if word.startswith(start)), "unknown")
    return Statement(line.number, kind if found is not None else "unknown", word, rest)


def values(text: str) -> list[tuple[str, str]]:
    """name=value, ... of a declaration: separated by commas or spaces; the value is empty where there is none."""
    return [(found[1], found[2] or "") for found in _VALUE.finditer(text)]
