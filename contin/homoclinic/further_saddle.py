"""Connecting orbits that come ever closer to one more saddle on their way: their curve ends at a chain of connections.

Where an orbit spends the time t near a further saddle, which it comes to at the rate s and leaves at the rate r, it
lies of the order exp(-min(r, s) t) beside the two orbits that end and begin there, in the parameters too: a curve of
homoclinic orbits winds into a T-point (Glendinning and Sparrow 1986), a pulse grows to a plateau between two fronts,
two pulses move apart. Below the error of the mesh the curve has told all; what follows is rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.problems.orbits.ends.distances import distances, extent_of
from contin.problems.orbits.ends.passage import NEAR, beside
from contin.problems.orbits.ends.saddles import Saddle, equilibrium_near, rounded
from contin.problems.orbits.march.slow_passage import slow_intervals, speeds
from contin.problems.orbits.mesh.layout import Profile
from contin.records import Fields

if TYPE_CHECKING:
    from contin.homoclinic.curve_of_connections import CurveOfConnections
    from contin.problems.orbits.orbit_equations import OrbitEquations

CLOSE: Final = 1e-4  # ... where the corrector fails: the equations are regular to a part of what remains


def further_saddle(
    problem: CurveOfConnections, z: Array, before: Array, scale: Array, sizes: Array, failed: bool = False
) -> End | None:  # fmt: skip
    """The end of a curve at z (its row before), which cannot be told from a chain of connections; None elsewhere.

    failed : the corrector can go no further, which is explained already by less than the mesh's error.
    """
    curve = problem.curve
    if curve.node or curve.aim is not None:
        return None
    profile, orbits = curve.orbit_of(z), curve.at(z)
    for saddle in _met(orbits, profile, sizes):
        off = _beside(orbits, profile, saddle, sizes)
        comes_closer = off < _beside(orbits, curve.orbit_of(before), saddle, sizes)
        if off < (CLOSE if failed else orbits.tolerance) and (comes_closer or failed):
            return _end(problem, z, saddle, off, scale, sizes)
    return None


def _met(orbits: OrbitEquations, profile: Profile, sizes: Array) -> list[Saddle]:
    """Hyperbolic saddles beside which the orbit dwells, between those that it leaves and comes to."""
    slow, (speed, _, _) = slow_intervals(orbits, profile, sizes), speeds(orbits, profile, sizes)
    fast = np.flatnonzero(~slow)
    found: list[Saddle] = []
    if not fast.size:
        return found
    bounds = np.flatnonzero(np.diff(fast) > 1)
    for k in bounds.tolist():
        left, right = int(fast[k]) + 1, int(fast[k + 1])
        u = profile.u[left + int(np.argmin(speed[left:right]))]
        near = equilibrium_near(orbits, u, profile.parameter, sizes)
        if near is None:
            continue
        rates = near.own.real
        hyperbolic = float(np.abs(rates).min()) >= 1e-6 * float(np.abs(near.own).max())
        if hyperbolic and np.any(rates > 0.0) and np.any(rates < 0.0):
            found.append(near)
    return found


def _beside(orbits: OrbitEquations, profile: Profile, saddle: Saddle, sizes: Array) -> float:
    """exp(-min(r, s) t) of the closest passage: one alone parts the orbit in two. 1 where there is none."""
    gaps = distances(orbits, saddle.u, profile.u, sizes) / extent_of(profile, sizes)
    times = profile.times * profile.period
    away = np.flatnonzero(gaps > NEAR)
    least = 1.0
    for left, right in zip(away[:-1].tolist(), away[1:].tolist(), strict=True):
        if right - left < 2:
            continue
        closest = left + 1 + int(np.argmin(gaps[left + 1 : right]))
        sides = float(times[closest] - times[left]), float(times[right] - times[closest])
        least = min(least, beside(float(gaps[closest]), sides))
    return least


def _end(problem: CurveOfConnections, z: Array, saddle: Saddle, off: float, scale: Array, sizes: Array) -> End:
    state = dict(zip(problem.system.state_names, rounded(saddle.u, sizes).tolist(), strict=True))
    own = any(float(np.max(np.abs(saddle.u - end) / sizes)) < 1e-6 for end in problem.curve.equilibria(z))
    values = {name: float(problem.parameter_columns(z[None])[name][0]) for name in problem.parameters}
    data: Fields = {"at": values, "error": off * float(scale[-1]), "saddle": state}
    data |= {"eigenvalues": saddle.eigenvalues, "saddle_quantity": saddle.quantity}
    place = ", ".join(f"{name} = {value:.8g}" for name, value in state.items())
    text = (
        f"the orbit stays ever longer near {'its' if own else 'a further'} saddle ({place}) on its way: from "
        f"{problem.place(z)} on it cannot be told from two connecting orbits in turn ({off:.0e} of the scales away)"
    )
    return End("homoclinic" if own else "heteroclinic", text, data)
