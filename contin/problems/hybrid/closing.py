"""Orbits that close beside a tangent landing, where errors of the states grow without bound."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.sampling import arc_samples

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents
    from contin.problems.hybrid.passage import Flown

CLOSED: Final = 1e-6  # of the states' sizes: an orbit is known to this
SHUT: Final = 1e-9  # ... and closes to this
CLOSINGS: Final = 3  # steps of Newton's method from an orbit that is known to `CLOSED` to one that does
TANGENT: Final = 0.05  # rate on landing, relative to its largest along the arc, that may be on its way to zero


def closes(problem: CycleOfEvents, f: Array, jacobian: Array) -> bool:
    """True where Newton's method, which may have stopped across a jump of the map, has no way to go.

    jacobian : of a family its last column, by the parameter, counts for nothing; on a curve all of them count.
    """
    n = problem.n
    states = jacobian[:, :-1] if len(f) == n else jacobian
    step = np.linalg.lstsq(states, f, rcond=None)[0][:n] if np.isfinite(states).all() else np.array([np.inf])
    return bool(np.max(np.abs(step) / problem.map.sizes[problem.map.kept]) < CLOSED)


def is_shut(problem: CycleOfEvents, z: Array) -> bool:
    """False for an orbit with an almost tangent landing that does not close, though its states are known to `CLOSED`.

    All that is computed of the orbit has errors then that are those of its states over the rate of that landing.
    """
    passage = problem.passage(z)
    if passage is None:
        return False
    gap = problem.inner.linearise(z)[0] / problem.map.sizes[problem.map.kept]
    if np.isfinite(gap).all() and np.max(np.abs(gap)) < SHUT:
        return True
    return all(abs(f.rate) >= TANGENT * usual_rate(problem, z, f) for f in passage.flown)


def shut(problem: CycleOfEvents, z: Array) -> Array:
    """The orbit closed to `SHUT` by Newton's method at its parameters; z itself where that is farther than `CLOSED`."""
    n, found = problem.n, z
    for _ in range(CLOSINGS):
        if is_shut(problem, found):
            return found
        f, jacobian = problem.inner.linearise(found)
        if not closes(problem, f, jacobian[:, : n + 1]):
            return z
        found = np.append(found[:n] - np.linalg.lstsq(jacobian[:, :n], f, rcond=None)[0], found[n:])
    return found if is_shut(problem, found) else z


def usual_rate(problem: CycleOfEvents, z: Array, flown: Flown) -> float:
    """How far h of an arc's event changes along the arc, by its time."""
    heights = problem.flow.heights(flown.arc.event, arc_samples(problem, z, flown), problem.inner.full_parameters(z))
    return float(np.ptp(heights)) / flown.time
