"""What names mean in an .ode file: without regard to case, by their first ten characters where XPP keeps no more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from contin.exchange.naming import Names

KEPT: Final = 10  # characters of a name that XPP tells apart


@dataclass(frozen=True)
class Symbol:
    """A declared name: what kind of thing it is, and what it is called here."""

    kind: str  # state, parameter, number, derived, fixed, noise, function
    name: str


class Symbols:
    """The declared names of one file."""

    def __init__(self, names: Names, notes: list[str]) -> None:
        self.names, self.notes = names, notes
        self.table: dict[str, Symbol] = {}
        self.short: dict[str, str] = {}
        self.order: list[str] = []  # states, then fixed quantities: what shift counts through
        self.constants: list[str] = []  # parameters and numbers, likewise

    def declare(self, spelled: str, kind: str, name: str | None = None) -> Symbol:
        """Note a name; what it is called is chosen here unless given."""
        key = spelled.lower()
        symbol = Symbol(kind, self.names.take(spelled) if name is None else name)
        self.table[key] = symbol
        first = self.short.setdefault(key[:KEPT], key)
        if first != key:
            self.notes.append(
                f"XPP keeps {KEPT} characters of a name and cannot tell {first} from {key}; here they are two"
            )
        return symbol

    def find(self, key: str) -> Symbol | None:
        """The meaning of a name in a formula (small letters)."""
        return self.table.get(self.full(key))

    def full(self, key: str) -> str:
        """The declared name (small letters) that a name in a formula means; itself where it means none."""
        return key if key in self.table or len(key) != KEPT else self.short.get(key, key)
