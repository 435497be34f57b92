"""Trajectories of piecewise-smooth (and smooth) flows from Python, with variations that jump at the crossings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import InputError, NotFiniteError
from contin.kernels.piecewise import flight as kernel
from contin.kernels.piecewise.flow import Flow, new_memory
from contin.model.evaluate import evaluate
from contin.simulate.chunks import CHUNK, Integrated, in_chunks, own_parameters
from contin.simulate.named import name_of_state
from contin.simulate.natural import SMALLER, absolute_tolerances, with_variations
from contin.simulate.section import Section, plane_of

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

RTOL = 1e-10
BUDGET = 5_000_000
STEPS_A_PERIOD = 16  # at least, where formulas may switch with the time, which no error estimate sees
STEPS_A_FLIGHT = 64  # the same without a period
CROSSINGS = 4096  # that many of the last crossings are kept
DONE, ESCAPED, SLIDING, STOPPED = "done", "escaped", "sliding", "stopped"


@dataclass(frozen=True, eq=False)
class Flight:
    """States at `times`, crossings of the section, the end, and how the flight ended.

    y = (u, v_1, .., v_k): rows of `samples` (times, n (1 + k)), `events` (K, 1 + n (1 + k)) with the time first, `end`.
    crossings (C, 2): time and number of the switching surface, at most the last `CROSSINGS`; `crossed`: how many.
    touched: crossings with (nearly) no speed, where variations are not defined.
    outcome: done, escaped (from the box), sliding, stopped (the step collapsed, not finite, budget used up).
    """

    n: int
    t: Array
    samples: Array
    events: Array
    end_time: float
    end: Array
    crossings: Array
    crossed: int
    touched: int
    steps: int
    outcome: str = DONE
    why: str = ""

    @property
    def u(self) -> Array:
        """States at the times, (T, n)."""
        return self.samples[:, : self.n]

    @property
    def variations(self) -> Array:
        """Variations at the end, (n, k)."""
        return self.end[self.n :].reshape(-1, self.n).T

    def finished(self) -> Flight:
        """Self; raises NotFiniteError where the flight did not come to its end."""
        if self.outcome != DONE:
            raise NotFiniteError(f"the trajectory stops at t = {self.end_time:.6g}: {self.why}")
        return self


def check_flight(system: CompiledSystem, duration: float) -> None:
    """Raises InputError for a map or a bad duration."""
    if system.kind == "map":
        raise InputError("a map has no trajectories in continuous time; iterate it")
    if not duration > 0.0:
        raise InputError(f"duration must be positive; got {duration!r}")


def fly(
    system: CompiledSystem, u: Array, p: Array, duration: float, *, start: float = 0.0, times: Array | None = None,
    section: Section | None = None, events: int = 0, variations: Array | None = None,
    columns: NDArray[np.int64] | None = None, rtol: float = RTOL, atol: float | Array | None = None,
    max_step: float = np.inf, box: float | Array = 1e100, budget: int = BUDGET, pieces: Any = None,
    steps: list[float] | None = None,
) -> Flight:  # fmt: skip
    """Integrate du/dt = f(u, p) over `duration`, or until `events` crossings of `section`.

    Each smooth piece is integrated with its own formula; crossings of switching surfaces are landed on exactly.

    variations : (n, k) initial vectors of v' = f_u v + f_q; they jump by the saltation matrix of every crossing.
    columns : (k,) index of q in z = (u, p) for sensitivities to a parameter, -1 for plain variations (the default).
    atol : of the states, one or (n,); by default a part of rtol in their natural sizes at the start.
    box : the largest modulus of a state, one or (n,), at which the flight ends as escaped.
    budget : most steps.  pieces : those of the system, perhaps with some surfaces held; by default none is.
    steps : gets the time at the end of every step.

    DOP853: about 1 us a step for small models; 2000 time units of the pair of metronomes, with 2700 crossings, 18 ms.
    Raises InputError for a map or a bad duration. All other trouble is an `outcome` in words.
    """
    check_flight(system, duration)
    n, y = int(system.n), np.array(u, dtype=float)
    pieces = system.pieces if pieces is None else pieces
    if y.shape != (n,):
        raise InputError(f"the start must have {n} values ({', '.join(system.state_names)}); got {y.size}")
    carried = 0 if variations is None else variations.shape[1]
    allowed = absolute_tolerances(system, y, np.asarray(p, dtype=float)[: system.m], SMALLER * rtol, atol)
    boxes = np.full(n, box, dtype=float)
    if variations is not None:
        y = np.concatenate([y, np.asarray(variations, dtype=float).T.ravel()])
    of = np.full(carried, -1, np.int64) if columns is None else shifted(columns, pieces)
    addresses = pieces.value_address, pieces.jacobian_address, pieces.surfaces_address
    flow = Flow(*addresses, n, pieces.count, pieces.first_mode, system.is_forced, of, plane_of(section, n))
    if system.is_forced and pieces.count:
        max_step = min(max_step, _step_where_time_switches(system, p, duration))
    memory = new_memory(n, pieces.count, pieces.p_size, y.size)  # type: ignore[no-untyped-call]
    memory.p[: pieces.first_mode] = np.asarray(p, dtype=float)[: pieces.first_mode]
    wanted = np.empty(0) if times is None else np.ascontiguousarray(times, dtype=float)
    samples, found = np.empty((wanted.size, y.size)), np.empty((max(events, 0), 1 + y.size))
    ring, counts = np.empty((CROSSINGS, 2)), np.zeros(7, np.int64)
    controls = np.array([start, start + duration, 0.0, max_step, rtol, start, 0.0, 0.0, 0.0])
    sensitive = None if columns is None else np.array([p[k - n] if n <= k < n + system.m else 0.0 for k in columns])
    errors = with_variations(allowed, SMALLER * rtol, variations, sensitive)
    flown = partial(kernel.fly, flow, memory, y, controls, errors, boxes)
    status, stiff, left = in_chunks(
        lambda started: _flown(flown, started, (wanted, samples, found, ring), counts, steps),
        Integrated(system, y[:n], memory.p, errors[:n]), controls, counts, budget,
    )  # fmt: skip
    crossed_last = counts[4] > 0 and ring[(counts[4] - 1) % CROSSINGS, 0] >= controls[0]
    if status == kernel.ESCAPED and not carried and not crossed_last:
        controls[0] = _leave(
            system, memory.begin, p, float(controls[5]), float(controls[0]), boxes, rtol, allowed, y
        )
    outcome, why = _outcome(system, status, y, memory, counts, budget, boxes, float(controls[0]), left, stiff)
    return Flight(
        n, wanted[: counts[0]], samples[: counts[0]], found[: counts[1]], float(controls[0]), y,
        _in_order(ring, int(counts[4])), int(counts[4]), int(counts[5]), int(counts[2]), outcome, why,
    )  # fmt: skip


def _in_order(ring: Array, crossed: int) -> Array:
    """The last crossings of `crossed` ones, in their order."""
    last = ring[:crossed] if crossed <= CROSSINGS else np.roll(ring, -(crossed % CROSSINGS), axis=0)
    return last.copy()


def _flown(
    flown: Callable[..., int], started: bool, into: tuple[Any, ...], counts: NDArray[np.int64],
    steps: list[float] | None
) -> int:  # fmt: skip
    """The kernel's status after CHUNK steps, whose ends are kept where they are wanted."""
    ends = np.empty(0 if steps is None else CHUNK)
    before = int(counts[2] - counts[3])
    status = flown(CHUNK, started, *into, counts, ends)
    if steps is not None:
        steps += ends[: int(counts[2] - counts[3]) - before].tolist()
    return status


def _leave(
    system: CompiledSystem, begin: Array, p: Array, low: float, high: float, box: Array, rtol: float, atol: Array,
    y: Array
) -> float:  # fmt: skip
    """When the last step, from `begin` at time `low`, leaves the box; puts the state there into y."""
    start, inside = low, begin.copy()
    for _ in range(50):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        flight = fly(system, inside, p, middle - start, start=start, rtol=rtol, atol=atol)
        if flight.outcome == DONE and bool(np.all(np.abs(flight.end) <= box)):
            low = middle
        else:
            high = middle
            if flight.outcome == DONE:
                y[:] = flight.end
    return high


def _step_where_time_switches(system: CompiledSystem, p: Array, duration: float) -> float:
    """The longest step where formulas may switch with the time."""
    if system.model.forcing is None:
        return duration / STEPS_A_FLIGHT
    return forcing_period(system, p) / STEPS_A_PERIOD


def forcing_period(system: CompiledSystem, p: Array) -> float:
    """Period of a forced model at these parameters."""
    values = dict(zip(system.parameter_names, np.asarray(p, dtype=float)[: system.m].tolist(), strict=True))
    return float(evaluate(system.forcing_period, values))


def shifted(columns: NDArray[np.int64], pieces: Any) -> NDArray[np.int64]:
    """Columns of (u, parameters, time) as columns of (u, parameters, modes, time)."""
    if not pieces.count:
        return columns
    last = pieces.n + pieces.first_mode
    return np.where(columns >= last, columns + pieces.count, columns)


def _outcome(
    system: CompiledSystem, status: int, y: Array, memory: Any, counts: NDArray[np.int64], budget: int, box: Array,
    t: float, left: float, stiff: bool,
) -> tuple[str, str]:  # fmt: skip
    """`outcome` and `why` of a flight."""
    outcome, why = _ended(system, status, y, memory, counts, budget, box, t, left)
    if stiff:
        why = f"stiff: {int(left):.2g} steps would still be needed; use the method Radau, LSODA or BDF"
    return outcome, why


def _ended(
    system: CompiledSystem, status: int, y: Array, memory: Any, counts: NDArray[np.int64], budget: int, box: Array,
    t: float, left: float,
) -> tuple[str, str]:  # fmt: skip
    if status in (kernel.DONE, kernel.EVENTS):
        return DONE, ""
    n = system.n
    if status == kernel.ESCAPED:
        k = int(np.argmax(np.abs(y[:n]) / box))
        return ESCAPED, f"left the box at t = {t:.6g}: |{name_of_state(system, k)}| exceeds {box[k]:.6g}"
    if status == kernel.SLIDING:
        surface = system.pieces.name(int(counts[6]))
        return SLIDING, (
            f"on {surface} both formulas lead back to the surface: the solution slides along it, which is not "
            "integrated (sliding motion needs Filippov's convention, out of scope)"
        )
    explained = system.why_not_finite(y[:n], own_parameters(system, memory.p))
    if explained:
        return STOPPED, str(explained)
    if status == kernel.STEPS and counts[2] <= budget:
        return STOPPED, f"{left:.2g} steps would still be needed, far more than the budget of {budget}"
    if status == kernel.STEPS:
        return STOPPED, (f"{budget} steps were not enough; a stiff model needs the method Radau, LSODA or BDF")
    return STOPPED, (
        "the step became too small: a singularity, a solution that escapes, or a stiff model (method Radau, LSODA, BDF)"
    )
