"""Limit cycles that trajectories come to, forwards in time (stable ones) or backwards (unstable ones)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.api.orbit_starts import periodic_orbit
from contin.errors import ContinError, NoSolutionError
from contin.machine import elementary
from contin.plane.field import PlanarField
from contin.plane.flights import Flight
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.search.hybrid_orbit import HybridOrbit
from contin.search.large_orbit_from_samples import LargeOrbit
from contin.search.shot_orbit import ShotOrbit
from contin.simulate.run import simulate

SAMPLES: Final = 1024
SAME: Final = 1e-4  # relative difference of periods
CLOSE: Final = 1e-2  # of the window: points of one cycle are as close to samples of the same
NEUTRAL: Final = 1e-6  # ... of a multiplier from 1: one of a family of closed orbits


@dataclass(frozen=True, eq=False)
class Cycle:
    """A limit cycle: points (K, 2), the period, and the multiplier exp(integral of the divergence)."""

    points: Array
    period: float
    multiplier: float

    @property
    def stable(self) -> bool:
        return self.multiplier < 1.0


def cycles(field: PlanarField, flights: Iterable[Flight], window: Array) -> list[Cycle]:
    """The different limit cycles on which flights that end in 'cycle' wind."""
    widths = window[:, 1] - window[:, 0]
    found: list[Cycle] = []
    for flight in flights:
        if flight.end != "cycle":
            continue
        cycle = _refined(field, flight, widths)
        if cycle is not None and not any(_same(cycle, other, widths, field.periods) for other in found):
            found.append(cycle)
    return found


def _refined(field: PlanarField, flight: Flight, widths: Array) -> Cycle | None:
    """The periodic orbit at the end of a flight, in the sense of time in which it attracts."""
    model = field.planar if flight.sense > 0 else field.backwards
    state = dict(zip(field.names, flight.points[-1].tolist(), strict=True))
    try:
        orbit = periodic_orbit(model, state, field.parameters)
        state = dict(zip(field.names, _first(orbit).tolist(), strict=True))
        whole = simulate(model, state, field.parameters, time=orbit.period, samples=SAMPLES + 1)
    except ContinError:  # no periodic orbit there, as of a weak focus: nothing is drawn that is not one
        return None
    if not whole.complete:
        return None
    if isinstance(orbit, HybridOrbit):  # across jumps: of the map from jump to jump
        slopes = np.asarray(orbit.map.jacobian(orbit.u, orbit.p)[1])[:, : orbit.u.size]
        multiplier = float(np.abs(np.linalg.eigvals(slopes)).max(initial=0.0))
        return Cycle(whole.states, float(orbit.period), multiplier)
    exponent = orbit.period * float(np.mean(field.trace(whole.states[:-1], widths)))
    if not np.isfinite(exponent) or abs(exponent) <= NEUTRAL:
        return None
    return Cycle(whole.states, float(orbit.period), float(elementary.exp(min(max(exponent, -700.0), 700.0))))


def _first(orbit: PeriodicOrbit | ShotOrbit | HybridOrbit | LargeOrbit) -> Array:
    """A point of the orbit: after the last jump, where there are any."""
    if isinstance(orbit, HybridOrbit):
        passage = orbit.map.passage(orbit.u, orbit.p)
        if passage is None:
            raise NoSolutionError("the orbit with jumps does not return")
        return np.asarray(passage.flown[-1].after, dtype=float)
    if isinstance(orbit, LargeOrbit):
        return orbit.problem.beginning(orbit.z)
    return np.asarray(orbit.profile.u[0] if isinstance(orbit, PeriodicOrbit) else orbit.nodes.u[0], dtype=float)


def _same(a: Cycle, b: Cycle, widths: Array, periods: Array) -> bool:
    """True for one cycle, whatever its phase; angles modulo their periods, those that go around not at all."""
    if not abs(a.period - b.period) <= SAME * a.period:
        return False
    for one, other in ((a, b), (b, a)):
        gap = other.points - one.points[0]
        gap -= periods * np.round(np.divide(gap, periods, out=np.zeros_like(gap), where=periods > 0.0))
        if float(np.abs(gap / widths).max(axis=1).min()) > CLOSE:
            return False
    return True
