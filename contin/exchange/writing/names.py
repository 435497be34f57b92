"""Names of a model as names of another language."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import count
from typing import Final

_GREEK: Final = re.compile(r"GREEK (SMALL|CAPITAL) LETTER (\w+)$")


@dataclass
class ForeignNames:
    """Gives out names that a language takes: ASCII, at most `longest` characters, none of `reserved`, each once.

    `fold`: capital and small letters are the same there, in `reserved` too.
    """

    reserved: frozenset[str]
    longest: int = 60
    fold: bool = False
    first: str = ""  # what a name must begin with
    used: set[str] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    def take(self, wanted: str, *, quiet: bool = False) -> str:
        """`wanted`, or what is nearest to it."""
        plain = self.first + (_ascii(wanted) or "v")
        if not plain[0].isalpha():
            plain = f"v{plain}"
        name, k = plain[: self.longest], 1
        while self._key(name) in self.used or self._key(name) in self.reserved:
            k += 1
            name = f"{plain[: self.longest - len(str(k))]}{k}"
        self.used.add(self._key(name))
        if name != self.first + wanted and not quiet:
            self.notes.append(f"{wanted} is called {name}")
        return name

    def all(self, wanted: Iterable[str]) -> dict[str, str]:
        """Names for several, by what was wanted."""
        return {name: self.take(name) for name in wanted}

    def fresh(self, stem: str = "q") -> Callable[[], str]:
        """A source of further names."""
        number = count(1)
        return lambda: self.take(f"{stem}{next(number)}", quiet=True)

    def _key(self, name: str) -> str:
        return name.lower() if self.fold else name


def _ascii(text: str) -> str:
    """Greek letters by their names, other letters without their marks."""
    found = []
    for letter in text:
        if letter.isascii():
            found.append(letter if letter.isalnum() or letter == "_" else "_")
            continue
        greek = _GREEK.match(unicodedata.name(letter, ""))
        if greek is not None:
            found.append(greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize())
        else:
            plain = unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode()
            found.append(plain if plain.isalnum() else "_")
    return "".join(found)
