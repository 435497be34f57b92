"""Trajectories in the plane, forwards or backwards in time, until they leave, come to rest or wind around a cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import ContinError
from contin.machine import elementary
from contin.plane.field import PlanarField, TwoStates
from contin.plane.rest import Rest
from contin.simulate.flight import ESCAPED
from contin.simulate.run import Simulation, simulate

SAMPLES: Final = 1500  # of a chunk of time
CHUNKS: Final = 14  # each twice as long as the one before
FIRST: Final = 6.0  # times of the field to cross the window, in the first chunk
FINE: Final = 2e-3  # parts of the window between points that are kept
GAP: Final = 2e-2  # ... between samples from which the trajectory is sampled again
REFINED: Final = 12  # runs of gaps in a chunk that are sampled again
MOST_AGAIN: Final = 4000  # samples
ARRIVED: Final = 2e-3  # ... from an equilibrium that attracts: the rest of the way is a point
ROUND: Final = 1e-3  # ... between a turn and the one before: a cycle, as far as a picture shows
OUTSIDE: Final = 0.5  # windows beyond the window at which a trajectory ends
FAR: Final = 4.0  # largest values in the window: the integration ends beyond
STEPS: Final = 400_000  # of the integrator in a chunk


@dataclass(frozen=True, eq=False)
class Flight:
    """Points (K, 2) in order of the flight; `sense` -1: backwards in time.

    end : left (the window), rest (`rest`: which equilibrium), cycle (winds around one, or around a weak focus),
    time (still on its way), or why the integration stopped.
    """

    points: Array
    sense: int
    end: str
    rest: int | None = None


def fly(
    field: PlanarField, start: Array, sense: int, window: Array, known: Sequence[Rest], least: float = 0.0
) -> Flight:
    """The trajectory from a point.  least : time that it needs to leave its start, at least."""
    widths = window[:, 1] - window[:, 0]
    model = field.planar if sense > 0 else field.backwards
    span, last = max(FIRST * crossing_time(field, window), least), np.asarray(start, dtype=float)
    path = [last[None]]
    for _ in range(CHUNKS):
        part, whole, why = _part(field, model, last, span, window)
        inside = _within(part, window, field.periods)
        if not inside.all():
            stop = int(np.argmin(inside))
            return Flight(_thinned(np.vstack([*path, part[:stop]]), widths), sense, "left")
        path.append(part[1:])
        points = _thinned(np.vstack(path), widths)
        if not whole:
            return Flight(points, sense, why)
        last, path, span = part[-1], [points], 2.0 * span
        near = _arrived(points, known, sense, widths, field.periods)
        if near is not None:
            return Flight(np.vstack([points, _beside(known[near].u, points[-1], field.periods)]), sense, "rest", near)
        turn = _turned(points, widths, field.periods)
        if turn is not None:
            return Flight(points[:turn], sense, "cycle")
    return Flight(points, sense, "time")


def crossing_time(field: PlanarField, window: Array) -> float:
    """The middle one, over a grid, of the times in which the field crosses the window."""
    x, y = (np.linspace(low, high, 17) for low, high in window)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    speed = np.abs(field.values(points) / (window[:, 1] - window[:, 0])).max(axis=1)
    moving = speed[np.isfinite(speed) & (speed > 0.0)]
    return float(1.0 / np.median(moving)) if moving.size else 1.0


def _part(field: PlanarField, model: TwoStates, start: Array, span: float, window: Array) -> tuple[Array, bool, str]:
    """Samples over a time; whether that time was reached; if not, why."""
    try:
        found = _simulated(field, model, start, span, SAMPLES, _box(field, window))
    except ContinError as error:
        return start[None], False, str(error)
    states, times = found.states, found.t
    if len(states) < 2:
        return start[None], False, found.why or found.outcome
    distance = np.abs(np.diff(states, axis=0) / (window[:, 1] - window[:, 0])).max(axis=1)
    rows, before = [], 0
    for first, last in _runs(np.flatnonzero(distance > GAP)):
        rows.append(states[before : first + 1])
        count = int(min(MOST_AGAIN, np.ceil(4.0 * float(distance[first:last].sum()) / GAP) + 2))
        rows.append(_simulated(field, model, states[first], float(times[last] - times[first]), count).states[1:-1])
        before = last
    rows.append(states[before:])
    return np.vstack(rows), found.complete, found.why if found.outcome != ESCAPED else "left"


def _runs(gaps: NDArray[np.intp]) -> list[tuple[int, int]]:
    """(first, last) samples of the longest runs of gaps; those next to each other are one."""
    parts = np.split(gaps, np.flatnonzero(np.diff(gaps) > 2) + 1) if gaps.size else []
    runs = [(int(part[0]), int(part[-1]) + 1) for part in parts]
    return sorted(sorted(runs, key=lambda run: run[0] - run[1])[:REFINED])


def _simulated(
    field: PlanarField, model: TwoStates, start: Array, span: float, samples: int, box: float = 1e100
) -> Simulation:
    state = dict(zip(field.names, start.tolist(), strict=True))
    return simulate(model, state, field.parameters, time=span, samples=samples, budget=STEPS, box=box)


def _box(field: PlanarField, window: Array) -> float:
    """A modulus of the states that only trajectories far outside have: none, where an angle goes around."""
    return 1e100 if np.any(field.periods > 0.0) else FAR * float(np.abs(window).max())


def _within(points: Array, window: Array, periods: Array) -> Array:
    slack = OUTSIDE * (window[:, 1] - window[:, 0])
    inside = (points >= window[:, 0] - slack) & (points <= window[:, 1] + slack)
    return np.asarray(np.all(inside | (periods > 0.0), axis=1))


def _thinned(points: Array, widths: Array) -> Array:
    """Points about `FINE` apart along the curve; the first and the last stay."""
    if len(points) < 3:
        return points
    steps = np.abs(np.diff(points, axis=0) / widths).max(axis=1)
    place = np.floor(np.append(0.0, np.cumsum(steps)) / FINE)
    keep = np.append(True, np.diff(place) > 0.0)
    keep[-1] = True
    return np.asarray(points[keep])


def _arrived(points: Array, known: Sequence[Rest], sense: int, widths: Array, periods: Array) -> int | None:
    """The equilibrium that attracts (in this sense of time) and has been reached."""
    wanted = "stable" if sense > 0 else "unstable"
    for k, rest in enumerate(known):
        if rest.stability in (wanted, "saddle", "neutral"):
            apart = np.abs((points[-1] - _beside(rest.u, points[-1], periods)) / widths).max()
            if apart < (ARRIVED if rest.stability == wanted else 0.1 * ARRIVED) and len(points) > 2:
                return k
    return None


def _beside(u: Array, near: Array, periods: Array) -> Array:
    """The copy of u (of angles) next to a point."""
    turns = np.divide(near - u, periods, out=np.zeros(2), where=periods > 0.0)
    return np.asarray(u + periods * np.round(turns))


def _turned(points: Array, widths: Array, periods: Array) -> int | None:
    """How many points there are when the curve comes back to where it was a turn before."""
    scaled, round_ = points / widths, periods / widths
    steps = np.diff(scaled, axis=0)
    length = np.append(0.0, np.cumsum(elementary.hypot(*steps.T)))
    if length[-1] < 20.0 * FINE:
        return None
    here, direction = scaled[-1], scaled[-1] - scaled[-2]
    behind = np.flatnonzero(length < length[-1] - 10.0 * FINE)
    gap = scaled[behind] - here
    gap -= round_ * np.round(np.divide(gap, round_, out=np.zeros_like(gap), where=round_ > 0.0))
    close = behind[elementary.hypot(*gap.T) < 1.5 * FINE]
    alike = [k for k in close if k + 1 < len(steps) and steps[k] @ direction > 0.0]
    if not alike:
        return None
    to, along = -gap[int(np.searchsorted(behind, alike[-1]))], steps[alike[-1]]
    across = abs(along[0] * to[1] - along[1] * to[0]) / elementary.hypot(*along)
    return len(points) if across < ROUND else None
