"""XPP's @ options, as far as contin has an equal for them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

_OPTION: Final = re.compile(r"([A-Za-z_]\w*)\s*=\s*([^\s,]+)", re.ASCII)
_NUMBERS: Final = frozenset(
    "total trans t0 tor_per parmin parmax ds dsmin dsmax ntst nmax rangelow rangehigh epsu epsl epss dt".split()
)


@dataclass
class Options:
    """Values of options by their names in small letters; `fold` names the states that are angles."""

    numbers: dict[str, float] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    fold: list[str] = field(default_factory=list)

    @property
    def discrete(self) -> bool:
        """True where the equations are iterated."""
        return self.words.get("meth", "").lower().startswith("di")

    def number(self, name: str) -> float | None:
        """The value of a numeric option."""
        return self.numbers.get(name)


def read_options(text: str, options: Options) -> None:
    """Add what one @ line sets; later lines win."""
    for name, value in _OPTION.findall(text):
        key = _known(name.lower())
        if key == "fold":
            options.fold.append(value)
        elif key in _NUMBERS:
            try:
                options.numbers[key] = float(value)
            except ValueError:
                continue
        else:
            options.words[key] = value


def _known(name: str) -> str:
    """XPP takes what begins like an option's name for it: transient is trans, method meth."""
    if name in _NUMBERS:
        return name
    return max((key for key in (*_NUMBERS, "meth", "fold", "rangeover") if name.startswith(key)), key=len, default=name)
