"""Where a family ends because its period grows without bound: an orbit with jumps that is homoclinic to a saddle.

Near it the period is T = -log|p - p*| / l + const., l the leading unstable eigenvalue of the saddle at which the orbit
dwells (Kuznetsov, Elements of Applied Bifurcation Theory, sec. 6.2): two orbits of the family give p*.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.linalg.newton import Rules, newton
from contin.machine import elementary
from contin.problems.hybrid.sampling import arc_samples

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents

CANDIDATES: Final = 8  # equilibria near the orbit that are looked at
NEWTON: Final = Rules(settled=1e-12, stalled=1e-12, budget=30)
NEAR: Final = 0.2  # of the states' sizes: the orbit comes so close to its saddle
DWELLS: Final = 8.0  # period times the leading eigenvalue, from which on the orbit's time is that at the saddle
FAR: Final = 30.0  # the extrapolated parameter is not further than so many last steps


def homoclinic_end(problem: CycleOfEvents, z: Array, before: Array) -> End | None:
    """The end at p*, with its saddle; None where the last two orbits do not approach one."""
    passages = problem.passage(z), problem.passage(before)
    if problem.flow.forced or passages[0] is None or passages[1] is None:
        return None
    longer = passages[0].period - passages[1].period
    p = problem.inner.full_parameters(z)
    states = np.vstack([arc_samples(problem, z, flown) for flown in passages[0].flown])
    period = passages[0].period
    found = next((s for s in _slowest(problem, states, p) if _is_approached(problem, s, states, period)), None)
    if found is None or not longer > 0.0:
        return None
    saddle, values = found
    rising, falling = values[values.real > 0.0], values[values.real < 0.0]
    ratio, step = float(elementary.exp(-float(rising.real[0]) * longer)), float(z[-1] - before[-1])
    at = float(z[-1] + step * ratio / (1.0 - ratio)) if ratio < 1.0 else np.nan
    if not abs(at - z[-1]) <= FAR * abs(step):
        return None
    name, names = problem.parameters[0], problem.system.state_names
    place = {k: float(v) for k, v in zip(names, saddle, strict=True)}
    words = ", ".join(f"{k} = {v:.6g}" for k, v in place.items())
    data = {
        "at": {name: at}, "error": abs(at - float(z[-1])), "saddle": place,
        "eigenvalues": [[float(v.real), float(v.imag)] for v in values],
        "saddle_quantity": float(rising.real[0] + falling.real.max()),
    }  # fmt: skip
    text = f"the period grows without bound towards a homoclinic orbit with jumps at {name} = {at:.8g}, to {words}"
    return End("homoclinic", text, data)


def _slowest(problem: CycleOfEvents, states: Array, p: Array) -> Iterator[tuple[Array, NDArray[np.complex128]]]:
    """Equilibria, with their eigenvalues, that Newton's method finds from where the orbit is slowest."""
    fields = np.array([problem.flow.system.value(u, p) for u in states])
    speeds = np.abs(fields / problem.map.sizes).max(axis=1)
    inner = (speeds[1:-1] <= speeds[:-2]) & (speeds[1:-1] <= speeds[2:])
    places = 1 + np.flatnonzero(inner)
    for k in places[np.argsort(speeds[places])][:CANDIDATES].tolist():
        found = _equilibrium(problem, states[k], p)
        if found is not None:
            values = np.linalg.eigvals(problem.flow.system.jacobian(found, p)[1][:, : problem.flow.n])
            yield found, values.astype(complex)


def _is_approached(
    problem: CycleOfEvents, found: tuple[Array, NDArray[np.complex128]], states: Array, period: float
) -> bool:
    """True for a saddle with one unstable eigenvalue that the orbit comes close to, and stays at for long."""
    saddle, values = found
    rising = values[values.real > 0.0]
    distance = float(np.min(np.max(np.abs((states - saddle) / problem.map.sizes), axis=1)))
    return distance < NEAR and len(rising) == 1 < len(values) and float(rising.real[0]) * period > DWELLS


def _equilibrium(problem: CycleOfEvents, u: Array, p: Array) -> Array | None:
    """The equilibrium of the flow that Newton's method finds from u."""

    def correct(u: Array) -> tuple[float, Array] | None:
        f, jacobian = problem.flow.system.jacobian(u, p)
        if not (np.isfinite(f).all() and np.isfinite(jacobian).all()):
            return None
        step = np.linalg.lstsq(jacobian[:, : problem.flow.n], -f, rcond=None)[0]
        return float(np.max(np.abs(step) / problem.map.sizes)), u + step

    found = newton(correct, u, NEWTON)
    return None if found is None else found.at
