"""Names on axes as they are printed: Greek letters, subscripts, units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

GREEK: Final = {
    "alpha": "\u03b1", "beta": "\u03b2", "gamma": "\u03b3", "delta": "\u03b4", "epsilon": "\u03b5", "eps": "\u03b5",
    "zeta": "\u03b6", "eta": "\u03b7", "theta": "\u03b8", "iota": "\u03b9", "kappa": "\u03ba", "lambda": "\u03bb",
    "lam": "\u03bb", "mu": "\u03bc", "nu": "\u03bd", "xi": "\u03be", "rho": "\u03c1", "sigma": "\u03c3",
    "tau": "\u03c4", "phi": "\u03c6", "chi": "\u03c7", "psi": "\u03c8", "omega": "\u03c9", "Gamma": "\u0393",
    "Delta": "\u0394", "Theta": "\u0398", "Lambda": "\u039b", "Xi": "\u039e", "Sigma": "\u03a3", "Phi": "\u03a6",
    "Psi": "\u03a8", "Omega": "\u03a9",
}  # fmt: skip
_SUBSCRIPTS: Final = str.maketrans("0123456789", "\u2080\u2081\u2082\u2083\u2084\u2085\u2086\u2087\u2088\u2089")
_DIGITS: Final = re.compile(r"(?<=[^\W\d_])_?(\d{1,2})\Z")


def typeset(name: str) -> str:
    """`mu` as a Greek letter, `x_1` and `x1` with a subscript; other names as they are (`mu_c`: the letter, then _c).

    Plain characters, no formulas: they look alike in files, windows and pages, and cost no time to set.
    """
    head, dot, tail = name.partition(".")
    base, found = head, _DIGITS.search(head)
    below = ""
    if found:
        base, below = head[: found.start()], found.group(1).translate(_SUBSCRIPTS)
    first, bar, rest = base.partition("_")
    return f"{GREEK.get(first, first)}{bar}{rest}{below}{dot}{tail}"


def axis_label(name: str, units: Mapping[str, str], suffix: str = "") -> str:
    """The text of an axis: name, what the strands of orbits are, unit."""
    unit = f" ({units[name]})" if units.get(name) else ""
    return f"{typeset(name)}{suffix}{unit}"
