"""The phase of an orbit: a section through a point that is far from where surfaces are crossed, and moving to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sampling import flights, states
from contin.simulate.flight import fly
from contin.simulate.section import Section

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

SAMPLES = 64  # of a period, for extrema of switching functions
CLOSE = 0.1  # an extremum this small, relative to the function's largest value, nearly touches


def busy_times(problem: ShotEquations, z: Array) -> Array:
    """Scaled times in [0, 1) at which the orbit crosses a switching surface, or nearly touches one."""
    period = Nodes.of(z, problem.n).period
    found = flights(problem, z, np.arange(SAMPLES) / SAMPLES)
    times = np.concatenate([f.crossings[:, 0] for f in found])
    return np.sort(np.append(times / period, _touched(problem, z, np.vstack([f.u for f in found]))))


def _touched(problem: ShotEquations, z: Array, u: Array) -> Array:
    """Scaled times of the extrema, close to zero, of switching functions; u are the states at equal times."""
    if not problem.system.n_switches or len(u) < SAMPLES:
        return np.empty(0)
    p = np.tile(problem.full_parameters(z), (SAMPLES, 1))
    if problem.system.is_forced:
        p[:, -1] = np.arange(SAMPLES) / SAMPLES * Nodes.of(z, problem.n).period
    h = np.asarray(problem.system.switches(u, p))
    turns = (h - np.roll(h, 1, axis=0)) * (np.roll(h, -1, axis=0) - h) <= 0.0
    return np.flatnonzero(np.any(turns & (np.abs(h) < CLOSE * np.abs(h).max(axis=0)), axis=1)) / SAMPLES


def quietest(problem: ShotEquations, z: Array) -> float:
    """The scaled time in the middle of the longest stretch without crossings and touchings (0 without either)."""
    times = busy_times(problem, z)
    if not times.size:
        return 0.0
    gaps = np.diff(np.append(times, times[0] + 1.0))
    k = int(np.argmax(gaps))
    return float((times[k] + 0.5 * gaps[k]) % 1.0)


def room(problem: ShotEquations, z: Array) -> float:
    """Scaled time between the base point and what is nearest of these, beside half the longest stretch: 1 is best."""
    times = busy_times(problem, z)
    if not times.size:
        return 1.0
    gaps = np.diff(np.append(times, times[0] + 1.0))
    return float(min(times[0], 1.0 - times[-1]) / (0.5 * gaps.max()))


def section_at(problem: ShotEquations, u: Array, p: Array, sizes: Array) -> tuple[Array, float]:
    """The plane through u that the flow crosses squarely in the metric of `sizes`; normal of unit scaled length.

    An angle has a part in it where the orbit winds round it: the others may hardly move, or turn.
    """
    normal = problem.system.value(u, p) / elementary.square(sizes)
    angles = np.asarray(problem.system.model.periods(problem.constants()), dtype=float) > 0.0
    apart = angles & (np.asarray(problem.winding) == 0.0)
    if np.any(normal[~apart] != 0.0):
        normal = np.where(apart, 0.0, normal)
    normal = normal / max(float(np.linalg.norm(normal * sizes)), 1e-300)
    return normal, float(normal @ u)


def rebased(problem: ShotEquations, z: Array, fraction: float, sizes: Array) -> Array:
    """The same orbit with its nodes moved by a fraction of the period, and the section through the new first node."""
    nodes = Nodes.of(z, problem.n)
    times = fraction + np.arange(nodes.count) / nodes.count
    turns = np.floor(times)
    order = np.argsort(times - turns)
    u = np.empty((nodes.count, problem.n))
    u[order] = states(problem, z, (times - turns)[order]) + turns[order, None] * problem.winding
    p = problem.full_parameters(z)
    if problem.autonomous:
        normal, offset = section_at(problem, u[0], p, sizes)
    else:
        normal, offset = np.zeros(problem.n), 0.0
    return Nodes(u, nodes.period, normal, offset, nodes.parameter).vector()


def onto_section(problem: ShotEquations, z: Array, fraction: float, target: Nodes) -> Array:
    """An orbit near the one of `target`, moved by about `fraction` of its period onto target's section."""
    nodes = Nodes.of(z, problem.n)
    p = problem.full_parameters(z)
    ahead = fraction - 0.1 if fraction > 0.1 else fraction + 0.9
    start = states(problem, z, np.array([ahead]))[0]
    turned = 0.0 if fraction > 0.1 else float(target.normal @ problem.winding)  # it is met after a turn
    section = Section(target.normal, target.offset + turned, 1)
    flight = fly(problem.system, start, p, 0.2 * nodes.period, section=section, events=1, rtol=1e-10)
    time = ahead + (flight.events[0, 0] / nodes.period if len(flight.events) else 0.1)
    moved = Nodes.of(rebased(problem, z, time % 1.0, np.ones(problem.n)), problem.n)
    return Nodes(moved.u, nodes.period, target.normal, target.offset, nodes.parameter).vector()
