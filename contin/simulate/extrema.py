"""Smallest and largest values of sampled functions; of a flow between its samples too, of a map at its iterates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.simulate.flight import fly
from contin.simulate.run import observed

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

FINER: Final = 32  # samples between two samples, around an extreme one
LEVELS: Final = 5  # looks, each so much finer
GAINED: Final = 1e-9  # of a column's range: a look after which less than this is left to gain is the last one,
BELOW: Final = 1e-6  # ... and by how much other turns may at most go higher that are not looked into any more, and
#   by how much a trajectory that passes samples may be off them
FLAT: Final = 1e-9  # ... and so is the first one of a column that is constant to this part of its size
ORDER: Final = elementary.pow(FINER / 2.0, 4)  # what a parabola misses shrinks by this from look to look
TURNS: Final = 32  # rows beside which an extreme is looked for, at most
ALIKE: Final = 0.5  # second differences of neighbours that differ by less are those of a smooth function


def extremes(values: Array) -> tuple[Array, Array]:
    """Smallest and largest of every column; NaN without rows."""
    if not len(values):
        nothing = np.full(values.shape[1], np.nan)
        return nothing, nothing
    return values.min(axis=0), values.max(axis=0)


def extremes_between(t: Array, values: Array, at: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The same of a function of time: `at(times)` gives values of all columns there, times (T,) ascending.

    It is looked at finer between the neighbours of rows that may be beside the extreme (`_candidates`: the largest
    sample need not be in the turn that goes highest), and again until the extreme stays where it is. There the smooth
    ones take a parabola; what jumps or has a corner takes its largest sample.
    """
    smallest, largest = extremes(values)
    spread = largest - smallest
    sides = [(column, sign) for column in range(values.shape[1]) for sign in (-1.0, 1.0)]
    turns = {(k, sign): _candidates(sign * values[:, k], spread[k]) for k, sign in sides}
    several = sorted({row for rows in turns.values() if len(rows) > 1 for row in rows})
    finer = _looks(t, values, several, at, spread)
    roughly = set(finer)
    for column, sign in sides:
        result, rows = smallest if sign < 0.0 else largest, turns[column, sign]
        best = sign * result[column]
        for row in rows:
            if row not in finer:
                finer[row] = _around(t, row, at)
        reaches = _at_most([sign * finer[row][1][:, column : column + 1].ravel() for row in rows])
        for place, k in enumerate(np.argsort(-reaches, kind="stable").tolist()):
            if place == 0 or reaches[k] > best + BELOW * spread[column]:
                if rows[k] in roughly and not np.isfinite(reaches[k]):
                    finer[rows[k]] = _around(t, rows[k], at)
                    roughly.remove(rows[k])
                best = _climbed(*finer[rows[k]], at, column, sign, best, spread[column])
        result[column] = sign * best
    return smallest, largest


def _looks(
    t: Array, values: Array, rows: Sequence[int], at: Callable[[Array], Array], spread: Array
) -> dict[int, tuple[Array, Array]]:
    """Times and values between the neighbours of rows, of many at once: `at` follows the function on through their
    samples, as long as it meets them (orbits part, observables jump).

    Rows at the ends are left out, and those that are not met from the sample before them.
    """
    allowed = BELOW * spread + FLAT * np.abs(values).max(axis=0)
    left, many = np.array([row for row in rows if 0 < row < len(t) - 1], dtype=int), len(rows)
    looks: dict[int, tuple[Array, Array]] = {}
    parts = np.arange(1, 2 * FINER + 1) / (2 * FINER)
    while len(left):
        now = left[:many]
        times = t[now - 1, None] + (t[now + 1] - t[now - 1])[:, None] * parts
        ascending, places = np.unique(np.hstack([times, t[now, None]]), return_inverse=True)
        found = at(ascending)
        found = np.vstack([found, np.full((len(ascending) - len(found), values.shape[1]), np.nan)])
        seen = found[places.reshape(len(now), -1)]
        met = np.all(np.abs(seen[:, -1] - values[now]) <= allowed, axis=1)
        count = len(met) if met.all() else int(np.argmin(met))
        looks.update(zip(now[:count].tolist(), zip(times, seen[:, :-1], strict=True), strict=False))
        many = 2 * count if count == len(met) else max(count, 1)
        left = left[max(count, 1) :]
    return looks


def _candidates(values: Array, spread: float) -> list[int]:
    """Rows beside which a function with these equally spaced samples may be largest: first the largest sample's.

    Others are as high as their neighbours. A parabola reaches an eighth of its bend (the second difference) above its
    largest sample, or less; twice that is allowed to functions that are none between samples.
    """
    largest = int(np.argmax(values))
    if len(values) < 3 or not np.all(np.isfinite(values)) or not spread > FLAT * float(np.abs(values).max()):
        return [largest]
    rises, bends = np.diff(values), np.abs(np.diff(values, 2))
    tops = np.flatnonzero(np.append(True, rises >= 0.0) & np.append(rises <= 0.0, True))
    reach = values[tops] + 0.25 * np.concatenate([bends[:1], bends, bends[-1:]])[tops]
    order = np.argsort(-reach, kind="stable")[:TURNS]
    return [largest, *(k for k in tops[order[reach[order] > values[largest]]].tolist() if k != largest)]


def _around(t: Array, row: int, at: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Times between a row's neighbours, and values of all columns at those that can be computed."""
    low, high = max(row - 1, 0), min(row + 1, len(t) - 1)
    if not t[high] > t[low]:
        return t[:0], np.empty((0, 0))
    times = np.linspace(t[low], t[high], FINER * (high - low) + 1)[1:]
    values = at(times)
    return times[: len(values)], values


def _climbed(
    times: Array, values: Array, at: Callable[[Array], Array], column: int, sign: float, best: float, spread: float
) -> float:  # fmt: skip
    """The largest sign * value of a column near the largest of these, or `best` where that is larger."""
    before = np.inf  # where the last look has seen the top
    for _ in range(LEVELS):
        seen = sign * values[:, column] if values.size else np.empty(0)
        if not len(seen) or not np.all(np.isfinite(seen)):
            return best
        found, row = top(seen), int(np.argmax(seen))
        before, moved = found, abs(found - before)
        beside = [seen[k] for k in (row - 1, row + 1) if 0 <= k < len(seen)]
        if is_resolved(seen):
            last = moved <= ORDER * GAINED * spread
        else:  # at an end the function may just end
            last = seen[row] in beside or not (len(beside) == 2 or found - best > GAINED * spread)
            best = max(best, found)
        if last or not spread > FLAT * abs(best):
            return max(best, found)
        times, values = _around(times, row, at)
    return max(best, before)


def _at_most(looks: Sequence[Array]) -> Array:
    """What equally spaced values (T,) may reach between them, of each look: a parabola misses s (1 - s^2)/6 of their
    third difference, at s <= 1/2 from the largest, or less than a fifteenth; twice that is allowed."""
    reaches = np.full(len(looks), np.inf)
    best = np.array([int(np.argmax(seen)) if seen.size else 0 for seen in looks])
    inner = [k for k, seen in enumerate(looks) if 2 <= best[k] <= len(seen) - 3 and np.all(np.isfinite(seen))]
    near = np.array([looks[k][best[k] - 2 : best[k] + 3] for k in inner]).reshape(-1, 5)
    left, bend, right = np.diff(near, 2).T
    uneven = np.maximum(np.abs(left - bend), np.abs(right - bend))
    resolved = (bend < 0.0) & (uneven < ALIKE * np.abs(bend))
    slope = 0.5 * (near[:, 3] - near[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        tops = near[:, 2] - 0.5 * slope * slope / bend
    reaches[inner] = np.where(resolved, tops + 0.125 * uneven, np.inf)
    return reaches


def top(values: Array) -> float:
    """Largest of equally spaced values; between them by a parabola where the second differences say that it is one."""
    best = int(np.argmax(values))
    if not is_resolved(values):
        return float(values[best])
    bend = float(np.diff(values[best - 1 : best + 2], 2)[0])
    slope = 0.5 * float(values[best + 1] - values[best - 1])
    return float(float(values[best]) - 0.5 * slope * slope / bend)


def is_resolved(values: Array) -> bool:
    """True where the largest of equally spaced values lies on a parabola with its neighbours."""
    best = int(np.argmax(values))
    if not 2 <= best <= len(values) - 3:
        return False
    left, bend, right = np.diff(values[best - 2 : best + 3], 2).tolist()
    return bool(bend < 0.0 and max(abs(left - bend), abs(right - bend)) < ALIKE * abs(bend))


def on_trajectory(
    system: CompiledSystem, p: Array, t: Array, states: Array, rtol: float, atol: Array
) -> Callable[[Array], Array]:
    """`at` for `extremes_between`: the observables on the trajectory through samples t (K,), states (K, n)."""

    def at(times: Array) -> Array:
        row = max(int(np.searchsorted(t, times[0], side="right")) - 1, 0)
        span, start = float(times[-1] - t[row]), float(t[row])
        flight = fly(system, states[row], p, span, start=start, times=times, rtol=rtol, atol=atol)
        return observed(system, flight.u, p, flight.t)

    return at
