"""What a phase plane consists of, as data."""

from __future__ import annotations

from dataclasses import dataclass

from contin.abi import Array
from contin.plane.cycles import Cycle
from contin.plane.field import Shown
from contin.plane.flights import Flight
from contin.plane.rest import Rest
from contin.plane.separatrices import Separatrix


@dataclass(frozen=True, eq=False, repr=False)
class PlaneParts:
    """What `PhasePlane` consists of; see there."""

    field: Shown
    window: Array
    nullclines: tuple[tuple[Array, ...], tuple[Array, ...]]
    rests: tuple[Rest, ...]
    separatrices: tuple[Separatrix, ...]
    cycles: tuple[Cycle, ...]
    trajectories: tuple[Flight, ...]
    notes: tuple[str, ...]
