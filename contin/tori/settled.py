"""The circle on which a trajectory has settled, found from the trajectory alone.

Of an autonomous flow the time T of a return is the mean time between crossings of a plane, the rotation number that of
the crossings; states at 0, T, 2 T, ... then lie on one circle at s = 0, rho, 2 rho, ... Means are weighted ones (Das,
Saiki, Sander and Yorke, 2017), which converge fast where the motion is quasiperiodic.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.machine import elementary
from contin.simulate.flight import DONE, fly
from contin.simulate.section import Section
from contin.systems.iterate import IteratedSystem
from contin.tori import fourier
from contin.tori.equations import Circle
from contin.tori.strobe import Strobe

SETTLING: Final = 3000  # returns before
RETURNS: Final = 2500
FIRST: Final = 40  # returns of a flow, or steps of about the period, in which its mean and its time scale are seen


def settled(strobe: Strobe, u: Array, value: float, count: int) -> tuple[Circle, Array]:
    """The circle, and the states (K, n) it was found from.

    Raises NoSolutionError where trajectories do not return.
    """
    if not strobe.free_time:
        time = strobe.time(value)
        for _ in range(SETTLING):
            u = strobe.image(u, time, value)
        points = [u]
        for _ in range(RETURNS):
            points.append(strobe.image(points[-1], time, value))
        states = np.array(points)
        rho = fourier.rotation(states)
    else:
        time = _scale(strobe, u, value)
        _, u = strobe.path(u, SETTLING * time, value, np.empty(0))
        time = _scale(strobe, u, value)
        time, rho = _returns(strobe, u, value, time)
        times = np.asarray(time * np.arange(1, RETURNS), dtype=float)
        states, _ = strobe.path(u, float(times[-1]), value, times)
    return Circle(fourier.fitted(states, rho, count), rho, time, value), states


def _scale(strobe: Strobe, u: Array, value: float) -> float:
    """About the time of a swing, 2 pi times deviations over speeds: at the start, then over `FIRST`."""
    speed = strobe.speed(u, value)
    time = 2.0 * np.pi * float(np.linalg.norm(u)) / (float(np.linalg.norm(speed)) or 1.0)
    for _ in range(2):
        seen, u = strobe.path(u, FIRST * time, value, np.linspace(0.0, FIRST * time, 50 * FIRST))
        speeds = np.array([strobe.speed(one, value) for one in seen])
        which = int(np.argmax(np.ptp(seen, axis=0)))
        time = 2.0 * np.pi * float(np.std(seen[:, which]) / (np.std(speeds[:, which]) or 1.0)) or time
    return time


def _returns(strobe: Strobe, u: Array, value: float, time: float) -> tuple[float, float]:
    """Mean time between upward crossings of the plane on which the state that swings most has its mean; their rho."""
    assert not isinstance(strobe.system, IteratedSystem)
    seen, _ = strobe.path(u, FIRST * time, value, np.linspace(0.0, FIRST * time, 50 * FIRST))
    which = int(np.argmax(np.ptp(seen, axis=0)))
    middle = 0.5 * float(seen[:, which].max() + seen[:, which].min())
    section = Section(np.eye(strobe.n)[which], middle, 1)
    flight = fly(
        strobe.system, u, strobe.parameters(value), 4.0 * RETURNS * time, section=section, events=RETURNS
    )
    if flight.outcome != DONE or len(flight.events) < RETURNS // 2:
        named = strobe.system.state_names[which]
        raise NoSolutionError(f"the trajectory does not keep returning to {named} = {middle:.6g}")
    crossings, points = flight.events[:, 0], np.delete(flight.events[:, 1 : 1 + strobe.n], which, axis=1)
    steps = np.diff(crossings)
    t = (np.arange(len(steps)) + 0.5) / len(steps)
    weight = elementary.exp(-1.0 / (t * (1.0 - t)))
    return float(steps @ weight / weight.sum()), fourier.rotation(points)
