"""A special orbit as its defining system is solved."""

from __future__ import annotations

from dataclasses import dataclass

from contin.abi import Array, Vector


@dataclass(frozen=True, eq=False)
class SolvedOrbit:
    """A special orbit: z, angle theta of a pair, scaled residual, error of p, null vectors in scaled unknowns."""

    z: Array
    theta: float
    residual: float
    error: float
    right: Vector
    scale: Array  # the metric
    finer: SolvedOrbit | None = None  # the same on a mesh of half the lengths; only interpolated if not confirmed
    confirmed: bool = True  # the same point was found on the finer mesh
