"""Names of foreign models as names of contin's."""

from __future__ import annotations

import re
from typing import Final

from contin.model.lexer import RESERVED
from contin.model.parts import TAKEN_NAMES
from contin.model.vocabulary import FUNCTIONS

_AVOIDED: Final = FUNCTIONS | RESERVED | TAKEN_NAMES


class Names:
    """Gives out names of contin's grammar, each once; what is changed is noted."""

    def __init__(self, notes: list[str]) -> None:
        self.notes = notes
        self.used: set[str] = set()

    def take(self, wanted: str, *, quiet: bool = False) -> str:
        """`wanted`, or what is nearest to it: no word of the grammar, no name twice."""
        name = cleaned(wanted)
        plain, k = name, 2
        while name in self.used:
            name, k = f"{plain}_{k}", k + 1
        self.used.add(name)
        if name != wanted and not quiet:
            self.notes.append(f"{wanted} is called {name}")
        return name


def cleaned(wanted: str) -> str:
    """`wanted` as a name of contin's grammar that is no word of it."""
    name = re.sub(r"\W", "_", wanted, flags=re.ASCII).strip("_" if not wanted.startswith("_") else "") or "_"
    if name[:1].isdigit():
        name = f"_{name}"
    return f"{name}_" if name in _AVOIDED else name


def label(text: str) -> str:
    """The name of a start, which becomes part of branch names."""
    return re.sub(r"[./~\s]+", "-", text).strip("-") or "start"
