"""Words and colours of kinds of branch; those of special points are in `contin.special`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from contin.special.special_type import SpecialType
from contin.special.table import special_type

KINDS: Final = {
    "equilibrium": "equilibria",
    "fixed-point": "fixed points",
    "orbit": "periodic orbits",
    "bvp": "boundary-value solutions",
    "locus": "locus",
    "connection": "connecting orbits",
    "torus": "invariant tori",
}

# Okabe and Ito (2008): told apart in every common form of colour blindness. Their yellow is too pale for a thin line.
PALETTE: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")


def style_of(type_code: str) -> SpecialType:
    """Words and signs of a type; types that later versions add are drawn too, without words of their own."""
    return special_type(type_code)


def locus_words(code: str | None, columns: Iterable[str] = ()) -> str:
    """What the points of a two-parameter curve are, e.g. 'Hopf points'; of connecting orbits its columns tell."""
    return (_connecting(columns) if code == "HOM" else None) or special_type(code or "").plural


def branch_words(kind: str, locus: str | None, columns: Iterable[str]) -> str:
    """What the points of a branch are."""
    return locus_words(locus, columns) if kind == "locus" else KINDS.get(kind, kind)


def _connecting(columns: Iterable[str]) -> str | None:
    """Between which ends orbits lead, by the columns of these; None where they are homoclinic."""
    ends = {name.split(".")[1] for name in columns if "." in name}
    if not any(end.startswith("cycle") for end in ends):
        return "heteroclinic orbits" if "saddle2" in ends else None
    if "cycle2" in ends:
        return "orbits from cycle to cycle"
    return "orbits from a cycle to an equilibrium" if "saddle2" in ends else "orbits from an equilibrium to a cycle"


def colour_of(code: str | None) -> str:
    """Of the curves of points of this type in two parameters."""
    colour = special_type(code or "").colour
    return colour if isinstance(colour, str) else PALETTE[-1 if colour is None else colour]


def dashes_of(code: str | None) -> Any:
    """... and their dashes, as matplotlib takes them."""
    dashes = special_type(code or "").dashes
    return (0, dashes) if dashes else "-"
