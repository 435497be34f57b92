"""Lyapunov exponents of a trajectory: lim (1/t) log |v(t)|, v a disturbance of it, in as many directions as asked for.

Disturbances grow by v' = f_u v and are made orthogonal again and again; the means of the logarithms of what they were
stretched by are the exponents (Benettin, Galgani, Giorgilli and Strelcyn 1980; Dieci and Van Vleck 1995).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.exponents.carriers import SMALLER, Carrier, FlowCarrier, JumpCarrier, MapCarrier
from contin.exponents.disturbances import Growth, generic_directions, logarithms, orthonormal
from contin.exponents.spectrum import LyapunovSpectrum
from contin.limits import check_count
from contin.model.advice import place_of_parameter
from contin.model.kinds import has_steps, need_model, need_time
from contin.model.model import Model
from contin.problems.hybrid.flow import HybridFlow
from contin.records import Record
from contin.simulate.consistent import consistent_start
from contin.simulate.natural import natural_metric
from contin.simulate.systems import in_time
from contin.symbolic.passes.conserved import with_named_totals

NATURAL_TIMES: Final = 20_000.0  # what is taken where no time is given; of a map: iterates
TRANSIENT: Final = 0.2  # of the time, where none is given: it comes before
ALL_UP_TO: Final = 10  # states, up to which all exponents are taken
SPREAD: Final = 6.0  # e-folds between the most and the least stretched direction after which they are made orthogonal
PARTS: Final = 128  # at least, whose logarithms are known
SHORT: Final = 100.0  # natural times (iterates), over which no error can be told
RTOL: Final = 1e-9
LEAST: Final = 1e-3  # natural sizes: what a smaller state is pushed by is a part of this
TRUSTED: Final = 100.0  # times rtol, relative: what integration may add to the error
BUDGET: Final = 50_000_000  # steps


@dataclass(frozen=True, eq=False)
class _Course:
    """A trajectory to follow: from u, in natural sizes `scale` (n,), with so many disturbances of `moving` states."""

    carrier: Carrier
    u: Array
    scale: Array
    natural: float
    moving: int
    is_map: bool


def lyapunov(
    model: Any, start: str | Record | None = None, parameters: Record | None = None, *, time: float | None = None,
    transient: float | None = None, count: int | None = None, parameter: str | None = None,
    values: Sequence[float] | None = None, rtol: float = RTOL, disturb: float = 1e-6,
    watch: Callable[[int, int], None] | None = None,
) -> LyapunovSpectrum:  # fmt: skip
    """Lyapunov exponents of the trajectory from a start, with errors, and its Kaplan-Yorke dimension.

    time : what the means are taken over (a map: iterates), by default 20,000 times the fastest time scale at the start;
    transient : what comes before, by default a fifth of it.  count : how many exponents, from the largest (default: all
    of up to 10 states, else 10).  parameter, values : one row for each value, each from where the last one ended,
    pushed off by `disturb` of the states: a motion that keeps a symmetry would keep it where it is unstable, too.
    rtol : of the integration (DOP853, with disturbances that jump at switching surfaces and `events`).

    A flow that does not come to rest has an exponent 0 along itself; a forced flow's time is not disturbed. The error
    of an exponent falls as 1/sqrt(time) in chaos, as 1/time elsewhere. They do not depend on coordinates.
    Raises InputError. A trajectory that escapes, slides or stops has nan, and `outcomes` says why.

    Cost: per time unit that of simulating 1 + count copies; Lorenz, 3 exponents to 0.002: 2 s.
    """
    need_model(model)
    need_time(model, "Lyapunov exponents")
    if (parameter is None) != (values is None):
        raise InputError("parameter and values belong together: parameter='a', values=[1, 1.5, 2]")
    for name, value in (("time", time), ("transient", transient), ("rtol", rtol)):
        if value is not None and not (np.isfinite(value) and value >= 0.0 and (value > 0.0 or name == "transient")):
            raise InputError(f"{name} must be a positive number; got {value!r}")
    if count is not None:
        check_count("count", count)
    if isinstance(model, Model):
        _need_disturbances(model)
        model = with_named_totals(model, [*([parameter] if parameter else []), *(parameters or ())])
    if parameter is not None:
        place_of_parameter(parameter, model.parameter_names)
    steps: list[Record] = [{}]
    if parameter is not None and values is not None:
        steps = [{parameter: float(v)} for v in values]
    if not steps:
        raise InputError("values: at least one is needed")

    found, u = [], None
    for k, step in enumerate(steps):
        course = _course(model, start, {**(parameters or {}), **step}, u, rtol, disturb)
        k_found = min(course.moving, count or max(1, min(course.moving, ALL_UP_TO)))
        growth, end, why, touched = _followed(course, time, transient, k_found)
        u = end if not why else None
        found.append((*_rates(growth, why, k_found, rtol, course.natural), growth.total, why or "done", touched))
        if watch is not None:
            watch(k + 1, len(steps))
    rates, errors, times, outcomes, touches = zip(*found, strict=True)
    shown = np.array([] if values is None else values, dtype=float)
    notes = tuple(
        f"row {k + 1}: the trajectory touches a surface where its equations switch, {many} times; there disturbances "
        "have no linear growth" for k, many in enumerate(touches) if many
    )  # fmt: skip
    complete = k_found == course.moving
    return LyapunovSpectrum(
        model, parameter or "", shown, np.array(rates), np.array(errors), np.array(times), outcomes, complete, notes
    )


def _need_disturbances(model: Model) -> None:
    """Raises InputError where disturbances have no equations here."""
    if model.mass:
        raise InputError(
            f"model {model.name!r} has a mass matrix: Lyapunov exponents are those of flows without one; solve the "
            "algebraic equations for their states, and divide the others by their masses"
        )
    if model.kind == "flow" and has_steps(model):
        raise InputError(
            f"model {model.name!r} has floor, ceil or mod of a state or of the time: how disturbances pass their jumps "
            "is not known; write the jump as a condition (u if c else v), or with `events`"
        )
    if not model.states:
        raise InputError(f"model {model.name!r} has no states, so nothing can be disturbed")


def _course(
    model: Any, start: str | Record | None, parameters: Record, u: Array | None, rtol: float, disturb: float
) -> _Course:
    jumping = isinstance(model, Model) and bool(model.events)
    bare = model.replace(events=()) if jumping else model
    begun, p = bare.start_point(start, dict(parameters))
    system = in_time(bare)
    n = int(system.n)
    begun = consistent_start(system, begun, p) if u is None else u[:n]
    metric = natural_metric(system, begun, p)
    if u is not None:
        signs = np.where(np.arange(n) % 2 == 0, 1.0, -1.0) * (1.0 + 0.1 * np.arange(n))
        begun = begun + disturb * signs * np.maximum(np.abs(begun), LEAST * metric.states)
    if model.kind == "map":
        return _Course(MapCarrier(system, p), begun, metric.states, 1.0, n, True)
    if not jumping:
        carrier = FlowCarrier(system, p, rtol, SMALLER * metric.tolerances(rtol))
        return _Course(carrier, begun, metric.states, metric.time, n, False)
    flow = HybridFlow(model)
    scale = np.append(metric.states, np.ones(flow.n - n))
    full = np.append(begun, np.zeros(flow.n - n) if u is None else u[n:])
    return _Course(JumpCarrier(flow, p, rtol, SMALLER * rtol * scale), full, scale, metric.time, n, False)


def _followed(
    course: _Course, time: float | None, transient: float | None, count: int
) -> tuple[Growth, Array, str, int]:
    """The growth after the transient, the last state, why it ended early ("" if not), and how often it touched."""
    whole = NATURAL_TIMES * course.natural if time is None else float(time)
    before = TRANSIENT * whole if transient is None else float(transient)
    if course.is_map:
        whole, before = float(round(whole)), float(round(before))
    u, t, directions = course.u, 0.0, generic_directions(course.moving, count)
    scale, rate = course.scale[:, None], 1.0 / course.natural
    stretched: list[Array] = []
    lengths: list[float] = []
    steps, touched, why = 0, 0, ""
    still = np.zeros((len(course.scale) - course.moving, count))  # the phase of the forcing
    for end in (before, before + whole):
        stretched, lengths = [], []
        while t < end * (1.0 - 1e-12) and not why:
            length = 1.0 if course.is_map else min(SPREAD / rate, whole / PARTS, end - t)
            if end - t - length < 0.01 * length:
                length = end - t
            carried = course.carrier.carry(u, scale * np.vstack([directions, still]), t, length)
            steps, touched, why = steps + carried.steps, touched + carried.touched, carried.why
            if why or steps > BUDGET or not np.isfinite(carried.columns).all():
                why = why or (f"{BUDGET} steps were not enough" if steps > BUDGET else "a disturbance has no bound")
                why = f"stopped at t = {t:.6g}: {why}"
                break
            directions, stretches = orthonormal((carried.columns / scale)[: course.moving])
            u, t = carried.u, t + length
            stretched.append(stretches)
            lengths.append(length)
            if not course.is_map:
                rate = _spreading(logarithms(stretches), length, rate)
    return Growth(logarithms(np.array(stretched).reshape(-1, count)), np.array(lengths)), u, why, touched


def _spreading(logs: Array, length: float, last: float) -> float:
    """How fast the directions part, from the last interval and, forgetting it slowly, the ones before."""
    alive = logs[np.isfinite(logs)]
    now = float(alive.max() - min(alive.min(), 0.0)) / length if alive.size else 0.0
    return max(now, 0.9 * last)


def _rates(growth: Growth, why: str, count: int, rtol: float, natural: float) -> tuple[Array, Array]:
    if why or not len(growth.times):
        return np.full(count, np.nan), np.full(count, np.nan)
    rates, errors = growth.rates()
    errors = np.where(np.isfinite(rates) & (growth.total < SHORT * natural), np.inf, errors)
    fastest = float(np.abs(rates[np.isfinite(rates)]).max(initial=0.0))
    return rates, np.where(np.isfinite(rates), errors + TRUSTED * rtol * fastest, errors)
