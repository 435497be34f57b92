"""Stable orbits of a region checked by a second method: a trajectory whose parameters go step by step to other points.

It starts on the orbit at the region's point, the parameters go straight to another point inside, and it has to go on
oscillating there. Nothing is continued or solved for; what the families of orbits said of the region is not used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.diagram.phase.checks import Check, Plane, others, place_of
from contin.diagram.phase.plane import Face
from contin.diagram.phase.states import State
from contin.diagram.sizes import sizes_among
from contin.errors import ContinError
from contin.simulate.trajectory import integrate

PATHS: Final = 2  # points of a region to which each of its stable orbits is led
LEGS: Final = (12, 60)  # steps of the parameters on the way; a path that fails is tried again with more of them
ROUNDS: Final = 4.0  # periods of the orbit that one of them takes
SETTLING: Final = 60.0  # ... for which the trajectory is left alone at the end
WINDOW: Final = 12.0  # ... in which it is looked at
SAMPLES: Final = 600  # of the window
STILL: Final = 1e-3  # extent in the window, as a part of the orbit's: less is rest
BUDGET: Final = 40_000  # Runge-Kutta steps of one leg, of the end, of the window: a path of more says nothing
TOLERANCE, SMALLER = 1e-7, 1e-2  # of the trajectories; absolute ones beside relative ones


def orbits_checked(plane: Plane, face: Face, point: Array, states: Sequence[State], name: str) -> Check:
    """The stable orbits at the region's point, led to others inside along straight ways."""
    stable = [s.orbit for s in states if s.orbit is not None and s.unstable == 0]
    led, disagreed = 0, []
    for other in others(face, point)[:PATHS] if stable else []:
        for problem, z in stable:
            profile = problem.profile(z)
            outcomes = [_goes_on(plane, profile.u, float(profile.period), point, other, LEGS[0])]
            if outcomes[0] is False:
                outcomes.append(_goes_on(plane, profile.u, float(profile.period), point, other, LEGS[1]))
            if None in outcomes:
                continue
            led += 1
            if not outcomes[-1]:
                place = place_of(plane, other)
                text = "a trajectory from a stable orbit at its point comes to rest at"
                disagreed.append(f"region {name}: {text} {place}")
    return Check(0, tuple(disagreed), led)


def _goes_on(plane: Plane, orbit: Array, period: float, a: Array, b: Array, legs: int) -> bool | None:
    """Whether a trajectory from the orbit (m, n) at a still oscillates when it is at b; None where it says nothing."""
    system = plane.problem.system
    extent = np.ptp(orbit, axis=0)
    largest = int(np.argmax(extent / np.maximum(np.abs(orbit).max(axis=0), 1e-300)))
    here = replace(plane.problem, base=plane.parameters(a))
    floor = TOLERANCE * SMALLER * sizes_among(here, [orbit], float(here.base[here.active]))
    u = orbit[0]
    try:
        for k in range(1, legs + 1):
            p, last = plane.parameters(a + k / legs * (b - a)), k == legs
            time = (SETTLING if last else ROUNDS) * period
            u = integrate(system, u, p, time, rtol=TOLERANCE, atol=floor, budget=BUDGET).end
        times = np.linspace(0.0, WINDOW * period, SAMPLES)
        window = integrate(system, u, p, float(times[-1]), times=times, rtol=TOLERANCE, atol=floor, budget=BUDGET).u
    except (ContinError, np.linalg.LinAlgError):  # it says nothing
        return None
    return bool(np.ptp(window[:, largest]) > STILL * extent[largest])
