"""Where a family ends because its period grows without bound: orbits that rest on the surface of an event of theirs.

A leaky integrator at its rheobase: where the equilibrium that it relaxes to is on the threshold at p*, the orbit takes
the time -log|p - p*| / l + const. to come there, l the slowest rate of decay, and beyond p* its event does not come.
The equilibrium and p* are solved for together: f = 0, h = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.linalg.newton import Converged, Rules, by_steps, solution
from contin.problems.orbits.ends.saddles import rounded

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents

NEWTON: Final = Rules(settled=1e-13, stalled=1e-10, budget=30)
ROUNDING: Final = 1e-14
NEAR: Final = 1e-2  # of the states' sizes: the orbit lands so close to the equilibrium
FAR: Final = 30.0  # last steps of the parameter: it is not further away
DWELLS: Final = 8.0  # period times the slowest rate of decay, from which on the orbit's time is that beside it


def boundary_equilibrium_end(problem: CycleOfEvents, z: Array, before: Array, event: int) -> End | None:
    """The end at p*, where orbits land on the surface of `event` ever more slowly; None where no equilibrium is."""
    passages = problem.passage(z), problem.passage(before)
    if problem.flow.forced or passages[0] is None or passages[1] is None:
        return None
    now, sizes = passages[0], problem.map.sizes
    if not now.period > passages[1].period:
        return None
    slowest = min((flown for flown in now.flown if flown.arc.event == event), key=lambda flown: abs(flown.rate)).before
    found = _on_surface(problem, event, np.append(slowest, z[-1]))
    if found is None or float(np.max(np.abs(found.at[:-1] - slowest) / sizes)) > NEAR:
        return None
    if not abs(found.at[-1] - z[-1]) <= FAR * abs(z[-1] - before[-1]):
        return None
    n, name = problem.flow.n, problem.parameters[0]
    at, error = float(found.at[-1]), max(found.left, ROUNDING) * _width(found.at)
    p = problem.inner.full_parameters(found.at)
    values = np.linalg.eigvals(problem.flow.system.jacobian(found.at[:-1], p)[1][:, :n]).astype(complex)
    slow = values[int(np.argmax(values.real))]
    if not slow.real < 0.0 or slow.imag != 0.0 or -float(slow.real) * now.period < DWELLS:
        return None
    place = rounded(found.at[:-1], sizes).tolist()
    words = ", ".join(f"{k} = {v:.8g}" for k, v in zip(problem.system.state_names, place, strict=True))
    text = (
        f"the period grows without bound (here {now.period:.6g}) towards {name} = {at:.12g}: the orbits rest at the "
        f"equilibrium ({words}) on the surface of {problem.flow.named(event)}"
    )
    return End("surface", text, {"at": {name: at}, "error": error, "event": event + 1})


def _on_surface(problem: CycleOfEvents, event: int, guess: Array) -> Converged[Array] | None:
    """The equilibrium and the parameter (u, p), near a guess, at which it is on the surface of the event."""
    n, system, active = problem.flow.n, problem.flow.system, problem.inner.active
    scale = np.append(problem.map.sizes, _width(guess))

    def step(z: Array) -> Array | None:
        p = problem.inner.full_parameters(z)
        f, jacobian = system.jacobian(z[:-1], p)
        surface = problem.flow.surface(event, z[:-1], p)
        both = np.vstack([jacobian, surface.gradient])[:, [*range(n), n + active]]
        right = np.append(f, surface.value)
        if not (np.isfinite(both).all() and np.isfinite(right).all()):
            return None
        rows = np.max(np.abs(both * scale), axis=1)
        return solution(both * scale / rows[:, None], -right / rows) if rows.all() else None

    return by_steps(step, guess, scale, NEWTON)


def _width(z: Array) -> float:
    return abs(float(z[-1])) or 1.0
