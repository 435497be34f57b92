"""Where an orbit touches switching surfaces, and how its segments are laid so that the touched ones may be held there.

A surface that is held keeps the formulas of the orbit's own side, so that the return map is smooth at a touching orbit:
that of the orbits which stay on that side, continued beyond.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.shooting.grazing import surface, surfaces
from contin.problems.shooting.number_of_segments import split
from contin.problems.shooting.phase import rebased
from contin.problems.shooting.sampling import flights

if TYPE_CHECKING:
    from contin.problems.shooting.shot_orbits import ShootingProblem


SAMPLES: Final = 1000  # of a period, for extrema of surface functions
FINER: Final = 1e-4  # (scaled time) between the three values of a parabola
NEAR: Final = 1e-3  # clearance, relative to the surface function's largest value, from which a touching orbit is near
TOUCHING: Final = 1e-6  # |h| at the extremum, relative to its largest value
ITSELF: Final = 1e-3  # (scaled time) crossings this near are those of a touching that rounding made one
MOST: Final = 32  # segments
EDGE: Final = 0.05  # part of a segment at both ends in which nothing should be touched
SHIFTS: Final = (0.0, 0.25, 0.5, 0.75)  # of the phase, in segments


@dataclass(frozen=True)
class Touch:
    """Surface, scaled time, the side (+-1, the sign of h) that the orbit comes from, and h at its extremum."""

    surface: int
    time: float
    side: int
    value: float = 0.0


def touches(problem: ShootingProblem, z: Array, within: float = TOUCHING) -> list[Touch]:
    """All places where an extremum of a surface function is zero, or `within` (relative to its largest value) of it."""
    times, found = np.arange(SAMPLES) / SAMPLES, []
    for j, h in enumerate(surfaces(problem, z, times).T):
        largest = float(np.abs(h).max())
        before, after = np.roll(h, 1), np.roll(h, -1)
        for k in np.flatnonzero(((h - before) * (after - h) <= 0.0) & (np.abs(h) < 0.1 * largest)):
            time, value, bend = vertex(lambda t, j=j: surface(problem, z, j, t % 1.0), float(times[k]), 1.0)
            if abs(value) <= within * largest and abs(time - times[k]) < 2.0 / SAMPLES and bend != 0.0:
                found.append(Touch(j, time % 1.0, int(np.sign(bend)), value))
    return found


def vertex(h: Any, guess: float, period: float) -> tuple[float, float, float]:
    """(time, value, second difference) of the extremum of h next to a guess, by parabolas through three values."""
    d, time = FINER * period, guess
    a = b = c = 0.0
    for _ in range(8):
        a, b, c = (float(x) for x in h(np.array([time - d, time, time + d])))
        bend = a - 2.0 * b + c
        if bend == 0.0 or not np.isfinite(bend):
            break
        step = float(np.clip(0.5 * d * (a - c) / bend, -20.0 * d, 20.0 * d))
        time += step
        if abs(step) < 1e-3 * d:
            b -= 0.125 * elementary.square(a - c) / bend
            break
    return time, b, a - 2.0 * b + c


def laid_out(problem: ShootingProblem, z: Array, found: Sequence[Touch]) -> tuple[Any, Array, list[Touch]] | None:
    """The problem with touched surfaces held in their segments, the orbit on these, and the touches at its phase.

    None where a surface is touched and crossed in too quick a succession.
    """
    crossings = [
        (float(t) / float(z[-problem.n - 3]), int(j)) for f in flights(problem, z, np.empty(0)) for t, j in f.crossings
    ]
    count = problem.count
    while count <= MOST:
        for shift in SHIFTS if problem.autonomous else SHIFTS[:1]:
            moved = [replace(t, time=(t.time - shift / count) % 1.0) for t in found]
            if _fits(count, moved, [((t - shift / count) % 1.0, j) for t, j in crossings]):
                whole = replace(problem, count=count)
                orbit = split(problem, z, count)
                if shift:
                    orbit = rebased(whole, orbit, shift / count, problem.state_sizes(problem.profile(z)))
                sides: dict[int, dict[int, int]] = {}
                for t in moved:
                    sides.setdefault(int(t.time * count), {})[t.surface] = t.side
                held = {i: problem.system.pieces.holding(signs) for i, signs in sides.items()}
                return replace(whole, held=held), orbit, moved
        count *= 2
    return None


def _fits(count: int, found: Sequence[Touch], crossings: Sequence[tuple[float, int]]) -> bool:
    for touch in found:
        segment = int(touch.time * count)
        if not EDGE < touch.time * count - segment < 1.0 - EDGE:
            return False
        own = [t for t in found if t.surface == touch.surface and int(t.time * count) == segment]
        if any(t.side != touch.side for t in own):
            return False
        for time, j in crossings:
            if j == touch.surface and int(time * count) == segment and all(abs(time - t.time) > ITSELF for t in own):
                return False
    return True
