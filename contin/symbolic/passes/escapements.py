"""Escapements by name: what keeps a metronome going, g(x, y) in x' = y, y' = -x + eps (-beta y + g).

Packages add theirs by entry points of the group `contin.escapements` (objects `Escapement`).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from typing import Final

from contin.errors import InputError
from contin.model.advice import closest

GROUP: Final = "contin.escapements"


@dataclass(frozen=True)
class Escapement:
    """`formula` of g in x, y and the parameters, with their values."""

    formula: str
    parameters: Mapping[str, float] = field(default_factory=dict)


OWN: Final[Mapping[str, Escapement]] = {
    "cubic": Escapement("a*x^3 - b*x^5 if x*y > 0 else 0", {"a": 4, "b": 1}),
    "constant": Escapement("a if x > low and x < high and y > 0 else 0", {"a": 4, "low": 0.5, "high": 1.0}),
    "van_der_pol": Escapement("a*(1 - x^2/theta^2)*y", {"a": 1, "theta": 1}),
}
"""The escapement of Kato and Kori's model (iii); a constant push on an interval; van der Pol's, as in Pantaleone."""


def escapement_of(name: str) -> Escapement:
    """The escapement of this name, of contin or of a package."""
    if name in OWN:
        return OWN[name]
    found = {} if os.environ.get("CONTIN_PLUGINS") == "0" else {e.name: e for e in entry_points(group=GROUP)}
    if name not in found:
        known = [*OWN, *found]
        advice = closest(name, known) or "there are " + ", ".join(known)
        raise InputError(f"no escapement {name!r}: {advice}, or a formula")
    loaded = found[name].load()
    if not isinstance(loaded, Escapement):
        raise InputError(f"the entry point {name} of {GROUP} must be an Escapement; it is {type(loaded).__name__}")
    return loaded
