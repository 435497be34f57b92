"""The equations of a curve of special points: extended ones for small flows, else minimally augmented ones."""

from __future__ import annotations

from typing import Any, Final

from contin.abi import Array
from contin.loci.equilibria.bordered import BorderedCurve
from contin.loci.equilibria.extended import ExtendedCurve
from contin.lowering.system import CompiledSystem

LARGE: Final = 50  # states beyond which minimally augmented systems take the place of extended ones


def curve_of(type_: str, system: Any, p: Array, first: int, second: int, sizes: Array) -> ExtendedCurve | BorderedCurve:
    """The curve of points of a type in parameters `first` and `second`; the others are those of p."""
    extended = system.kind != "map" and system.n <= LARGE and isinstance(system, CompiledSystem)
    make = ExtendedCurve if extended else BorderedCurve
    return make(type_, system, p.copy(), first, second, sizes.copy())
