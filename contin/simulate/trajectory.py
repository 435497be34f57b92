"""Trajectories of a compiled model from Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.errors import NotFiniteError
from contin.kernels import runge_kutta as kernel
from contin.simulate.flight import check_flight, fly
from contin.simulate.named import name_of_state
from contin.simulate.natural import SMALLER, above_rounding, absolute_tolerances, with_variations
from contin.simulate.section import Section, plane_of

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

__all__ = ["Section", "Trajectory", "integrate"]

RTOL = 1e-10
CHUNK = 20_000  # steps between two looks at Ctrl-C


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States u (len(t), n) at times t, crossings of a section (time, state), and the state at the end.

    `variations` (len(t), n, k) where the variational equation was integrated too.
    """

    t: Array
    u: Array
    event_times: Array
    event_states: Array
    end_time: float
    end: Array
    steps: int
    variations: Array | None = None


def integrate(
    system: CompiledSystem, u: Array, p: Array, duration: float, *, start: float = 0.0, times: Array | None = None,
    section: Section | None = None, events: int = 0, variations: Array | None = None, rtol: float = RTOL,
    atol: float | Array | None = None, max_step: float = np.inf, budget: int = 5_000_000,
) -> Trajectory:  # fmt: skip
    """Integrate du/dt = f(u, p) over `duration`, or until `events` crossings of `section` were found.

    DOP853 (order 8, adaptive) with 7th-order dense output. times : increasing, at which the state is wanted.
    variations : (n, k) initial vectors of v' = f_u v. atol : of the states, (n,) or one for all; by default a part of
    rtol in their natural sizes at the start. Smooth non-stiff flows; about 1 us a step for small models.

    Raises InputError for a map or a bad duration, NotFiniteError where the solution leaves the equations' domain or
    the budget of steps is used up (a stiff model: see
    `contin.simulate.stiff`). A piecewise-smooth flow is integrated piece by piece (`contin.simulate.flight`).
    """
    check_flight(system, duration)
    if system.n_switches:
        return _in_pieces(
            system, u, p, duration, start=start, times=times, section=section, events=events, variations=variations,
            rtol=rtol, atol=atol, max_step=max_step, budget=budget,
        )  # fmt: skip
    n = system.n
    allowed = absolute_tolerances(system, u, p, SMALLER * rtol, atol)
    y = np.array(u, dtype=float)
    if variations is not None:
        y = np.concatenate([y, np.asarray(variations, dtype=float).T.ravel()])
    full = np.zeros(system.p_size)
    full[: len(p)] = p
    wanted = np.empty(0) if times is None else np.ascontiguousarray(times, dtype=float)
    samples, found = np.empty((wanted.size, y.size)), np.empty((max(events, 0), 1 + y.size))
    plane = plane_of(section, n)
    counts = np.zeros(4, np.int64)
    controls = np.array([start, start + duration, 0.0, max_step, rtol])
    memory = kernel.new_work(y.size, n, system.p_size)  # type: ignore[no-untyped-call]
    while True:
        status = kernel.integrate(
            system.value_address, system.jacobian_address, system.is_forced, y, full, controls,
            with_variations(allowed, SMALLER * rtol, variations), CHUNK, plane, wanted, samples, found, counts, *memory,
        )  # fmt: skip
        if status not in (kernel.STEPS, kernel.SMALL) or counts[2] > budget:
            break
        raised = above_rounding(system, allowed, y[:n], full)
        if status == kernel.SMALL and np.array_equal(raised, allowed):
            break
        allowed = raised
    if status in (kernel.SMALL, kernel.NOT_FINITE, kernel.STEPS):
        why = system.why_not_finite(y[:n], full) or (
            "the step became too small: a singularity, or a solution that escapes"
            if status != kernel.STEPS
            else f"{budget} steps were not enough, at {_largest(system, y[:n])}: the model may be stiff (use "
            "contin.simulate.stiff), or the solution escapes"
        )
        raise NotFiniteError(f"the trajectory stops at t = {controls[0]:.6g}: {why}")
    taken = int(counts[0])
    crossings = found[: int(counts[1])]
    carried = None if variations is None else np.moveaxis(samples[:taken, n:].reshape(taken, -1, n), 1, 2)
    return Trajectory(
        wanted[:taken], samples[:taken, :n], crossings[:, 0], crossings[:, 1 : 1 + n], float(controls[0]), y[:n].copy(),
        int(counts[2]), carried,
    )  # fmt: skip


def _largest(system: CompiledSystem, u: Array) -> str:
    """The state of largest modulus and its value."""
    k = int(np.argmax(np.abs(u)))
    return f"{name_of_state(system, k)} = {u[k]:.3g}"


def _in_pieces(system: CompiledSystem, u: Array, p: Array, duration: float, **options: Any) -> Trajectory:
    flight = fly(system, u, p, duration, **options).finished()
    n, taken = system.n, len(flight.t)
    carried = None
    if options["variations"] is not None:
        carried = np.moveaxis(flight.samples[:, n:].reshape(taken, -1, n), 1, 2)
    events = flight.events
    return Trajectory(
        flight.t, flight.u, events[:, 0], events[:, 1 : 1 + n], flight.end_time, flight.end[:n].copy(), flight.steps,
        carried,
    )  # fmt: skip
