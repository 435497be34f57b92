"""Words, shapes and colours of the field's codes: one table for legends, tooltips and the terminal report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class TypeStyle:
    """How a type of special point is named and drawn; `marker` is matplotlib's code, `symbol` the viewer's shape."""

    words: str
    marker: str
    symbol: str


TYPES: Final[dict[str, TypeStyle]] = {
    "LP": TypeStyle("fold", "s", "square"),
    "BP": TypeStyle("branch point", "D", "diamond"),
    "HB": TypeStyle("Hopf point", "o", "circle"),
    "PD": TypeStyle("period doubling", "^", "triangle-up"),
    "NS": TypeStyle("torus (Neimark-Sacker) point", "p", "pentagon"),
    "LPC": TypeStyle("fold of orbits", ">", "triangle-right"),
    "BPC": TypeStyle("branch point of orbits", "d", "thin-diamond"),
    "HOM": TypeStyle("homoclinic orbit", "*", "star"),
    "BE": TypeStyle("boundary equilibrium", "H", "hexagon"),
    "UZ": TypeStyle("user value", "x", "cross"),
    "CP": TypeStyle("cusp", "v", "triangle-down"),
    "BT": TypeStyle("Bogdanov-Takens point", "h", "hexagon"),
    "GH": TypeStyle("generalised Hopf (Bautin) point", "P", "plus"),
    "ZH": TypeStyle("zero-Hopf point", "8", "octagon"),
    "HH": TypeStyle("double Hopf point", "X", "saltire"),
    "DP": TypeStyle("degenerate branch point", "d", "thin-diamond"),
    "TZ": TypeStyle("triple zero", "H", "hexagon"),
    "CPC": TypeStyle("cusp of orbits", "v", "triangle-down"),
    "R1": TypeStyle("1:1 resonance", "<", "triangle-left"),
    "R2": TypeStyle("1:2 resonance", ">", "triangle-right"),
    "R3": TypeStyle("1:3 resonance", "1", "tri-down"),
    "R4": TypeStyle("1:4 resonance", "2", "tri-up"),
    "CH": TypeStyle("Chenciner point", "P", "plus"),
    "GPD": TypeStyle("generalised period doubling", "H", "hexagon"),
    "LPPD": TypeStyle("fold and period doubling", "8", "octagon"),
    "LPNS": TypeStyle("fold and torus point", "X", "saltire"),
    "PDNS": TypeStyle("period doubling and torus point", "d", "thin-diamond"),
    "NSNS": TypeStyle("double torus point", "*", "star"),
    "NSS": TypeStyle("resonance of real leading eigenvalues", "<", "triangle-left"),
    "NSF": TypeStyle("resonance of a pair and a real eigenvalue", ">", "triangle-right"),
    "NFF": TypeStyle("resonance of two pairs", "1", "tri-down"),
    "NCH": TypeStyle("non-central saddle-node homoclinic orbit", "s", "square"),
    "SH": TypeStyle("Shilnikov-Hopf point", "o", "circle"),
    "OFS": TypeStyle("orbit flip, stable side", "^", "triangle-up"),
    "OFU": TypeStyle("orbit flip, unstable side", "v", "triangle-down"),
    "IFS": TypeStyle("inclination flip, stable side", "P", "plus"),
    "IFU": TypeStyle("inclination flip, unstable side", "X", "saltire"),
}
UNKNOWN_TYPE: Final = TypeStyle("special point", "o", "circle")

KINDS: Final = {
    "equilibrium": "equilibria",
    "fixed-point": "fixed points",
    "orbit": "periodic orbits",
    "bvp": "boundary-value solutions",
    "locus": "locus",
}

# Okabe and Ito (2008): told apart in every common form of colour blindness. Their yellow is too pale for a thin line.
PALETTE: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")


def style_of(type_code: str) -> TypeStyle:
    """The style of a type; types that later versions add are drawn too, without words of their own."""
    return TYPES.get(type_code, UNKNOWN_TYPE)


def locus_words(code: str | None) -> str:
    """What the points of a two-parameter curve are, e.g. 'Hopf points'."""
    if code == "UZ":
        return "orbits of one period"
    words = TYPES[code].words if code in TYPES else "special points"
    if code in ("LPC", "BPC", "CPC"):
        first, rest = words.split(" ", 1) if code != "BPC" else ("branch points", "of orbits")
        return f"{first if first.endswith('s') else first + 's'} {rest}"
    return words if words.endswith("s") or words.endswith("doubling") else words + "s"
