"""Connecting orbits of piecewise-smooth flows: collocation is right only for those that stay on one side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.model.printing import to_text

if TYPE_CHECKING:
    from contin.homoclinic.equations import ConnectionCurve


def surface_met(curve: ConnectionCurve, z: Array) -> str | None:
    """The switching function, in words, that changes sign along the orbit; None where there is none."""
    system = curve.orbits.system
    if not system.n_switches or system.pieces.count == 0:
        return None
    u = curve.orbit_of(z).u
    h = system.switches(u, np.ascontiguousarray(np.tile(curve.full_parameters(z), (len(u), 1))))
    met = np.flatnonzero((h.min(axis=0) < 0.0) & (h.max(axis=0) > 0.0))
    return f"{to_text(system.switching[int(met[0])])} = 0" if met.size else None


def why_not(surface: str) -> str:
    """What that means, in words."""
    return (
        f"Beyond, the connecting orbits cross the switching surface {surface}: those of a piecewise-smooth flow are "
        "followed only as long as they stay on one side of every surface."
    )
