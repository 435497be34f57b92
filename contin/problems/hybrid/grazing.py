"""Where a family ends because its cycle of events changes: a solution touches the surface of an event.

Either an event that is not in the cycle comes in (its surface is touched from the side on which it does not happen), or
one of the cycle does not come any more (its own crossing becomes tangent: the rate of h on landing falls to zero like
the square root of the distance in the parameter, and the map's derivative grows without bound).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.hybrid.boundary_end import boundary_equilibrium_end
from contin.problems.hybrid.closing import TANGENT, closes, usual_rate
from contin.problems.hybrid.homoclinic_end import homoclinic_end
from contin.problems.hybrid.landing import first_landing
from contin.problems.hybrid.saddle_node_end import saddle_node_end
from contin.problems.hybrid.sampling import arc_samples
from contin.simulate.resets import SENSES

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents
    from contin.problems.hybrid.passage import Flown, Passage


class OfCycles(Protocol):
    """Orbits with a fixed cycle of events, in one parameter or two."""

    def unexpected(self, z: Array) -> tuple[int, int] | None:
        """(event, arc) of the first event on the orbit that its cycle does not have."""

    def is_shut(self, z: Array) -> bool:
        """See `contin.problems.hybrid.closing`."""

    def shut(self, z: Array) -> Array:
        """See `contin.problems.hybrid.closing`."""

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem`."""

    def placed(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Array | None:
        """The unknowns of `probe`, without its tests: those of doublings take third derivatives of the map."""


BEFORE_END: Final = 1e-9  # part of an arc before its end: what happens there happens with the arc's event
HALVINGS: Final = 60
LOCATED: Final = 1e-12  # (arclength, relative to the step)
TOUCHES: Final = 1e-5  # clearance, relative to how far h changes over the orbit, of an orbit that touches its surface


def unexpected(problem: CycleOfEvents, z: Array) -> tuple[int, int] | None:
    """(event, arc) of the first event on the orbit that its cycle does not have."""
    passage = problem.passage(z)
    if passage is None:
        return None
    if not closes(problem, *problem.inner.linearise(z)):  # an event of the cycle came too early
        return passage.flown[0].arc.event, 0
    return _not_in_cycle(problem, passage, z)


def unexpected_on_curve(problem: CycleOfEvents, z: Array, f: Array, jacobian: Array) -> tuple[int, int] | None:
    """The same of an orbit on a curve of special orbits, whose equations and their Jacobian these are."""
    passage = problem.passage(z)
    if passage is None:
        return None
    if not closes(problem, f, jacobian):
        return passage.flown[0].arc.event, 0
    return _not_in_cycle(problem, passage, z)


def _not_in_cycle(problem: CycleOfEvents, passage: Passage, z: Array) -> tuple[int, int] | None:
    """(event, arc) of the first event on an orbit that its cycle does not have."""
    flow, p, sizes = problem.flow, problem.inner.full_parameters(z), problem.map.sizes
    for number, flown in enumerate(passage.flown):
        for k in range(len(flow.model.events)):
            horizon = (1.0 - BEFORE_END) * flown.time
            if k != flown.arc.event:
                early = first_landing(flow, k, flown.begin, p, sizes, flown.time, horizon, exactly=True)
                if early is not None:
                    return k, number
            if k not in (flown.arc.event, *flown.arc.then) and _carried(problem, flown, k, p):
                return k, number
    return None


def _carried(problem: CycleOfEvents, flown: Flown, k: int, p: Array) -> bool:
    """True where the jump at the end of an arc carries h of event k through zero, in its direction."""
    before, after = problem.flow.heights(k, np.array([flown.before, flown.after]), p)
    small = BEFORE_END * flown.time * abs(problem.flow.surface(k, flown.before, p).rate)
    crossed = before * after < 0.0 and min(abs(before), abs(after)) > small
    return bool(crossed and np.sign(after) in SENSES[problem.flow.model.events[k].direction])


def cut_where_events_change(problem: OfCycles, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """The chunk up to the orbit at which another event comes in, which is its last row then."""
    if chunk.stop is Stop.NOT_FINITE:  # beyond, an event of the cycle does not come
        chunk = replace(chunk, stop=Stop.CORRECTOR)
    chunk = _closed_rows(problem, chunk, frame, settings)
    row = next((r for r in range(1, len(chunk)) if _is_beyond(problem, chunk.z[r])), None)
    if row is None:
        return chunk
    base = chunk.sample(row - 1)
    last = _last_with_cycle(problem, base, chunk.z[row], float(chunk.lengths[row]), frame, settings)
    cut = chunk.cut(row, Stop.CORRECTOR, float(chunk.lengths[row]))
    return cut if last is None else _appended(cut, *last)


def _is_beyond(problem: OfCycles, z: Array) -> bool:
    """True where the orbit has another cycle of events, none, or a landing so tangent that nothing of it is known."""
    return problem.unexpected(z) is not None or not problem.is_shut(z)


def _last_with_cycle(
    problem: OfCycles, base: Sample, beyond: Array, length: float, frame: Frame, settings: Settings
) -> tuple[Sample, float] | None:
    """The last orbit of the family, within a step of this length from `base`, that has its cycle; and how far it is."""

    def at(part: float) -> tuple[Sample, float, Array, Frame, Settings]:
        return base, part, base.z + part / length * (beyond - base.z), frame, settings

    low, high = 0.0, length
    for _ in range(HALVINGS):
        if high - low <= LOCATED * length:
            break
        middle = 0.5 * (low + high)
        z = problem.placed(*at(middle))
        if z is not None and not _is_beyond(problem, problem.shut(z)):
            low = middle
        else:
            high = middle
    found = problem.probe(*at(low)) if low > 0.0 else None
    return None if found is None else (_closed(problem, found, frame, settings), low)


def _closed(problem: OfCycles, sample: Sample, frame: Frame, settings: Settings) -> Sample:
    """A point whose orbit is closed by `shut`, with its multipliers, which change with it beside a tangent landing."""
    z = problem.shut(sample.z)
    again = None if z is sample.z else problem.probe(replace(sample, z=z), 0.0, z, frame, settings)
    return sample if again is None else again


def _closed_rows(problem: OfCycles, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """All rows so."""
    z, unstable, eigenvalues = chunk.z.copy(), chunk.unstable.copy(), chunk.eigenvalues.copy()
    for r in range(len(chunk)):
        row = _closed(problem, chunk.sample(r), frame, settings)
        z[r], unstable[r], eigenvalues[r] = row.z, row.unstable, row.eigenvalues
    return replace(chunk, z=z, unstable=unstable, eigenvalues=eigenvalues)


def _appended(chunk: Chunk, sample: Sample, length: float) -> Chunk:
    """The chunk with one row more."""
    return Chunk(
        np.vstack([chunk.z, sample.z]), np.vstack([chunk.tangents, sample.tangent]),
        np.vstack([chunk.tests, sample.tests]), np.append(chunk.unstable, sample.unstable),
        np.vstack([chunk.eigenvalues, sample.eigenvalues]), np.append(chunk.lengths, length), chunk.stop,
        chunk.next_step, chunk.reference, chunk.dipped, chunk.evaluations, chunk.detail,
    )  # fmt: skip


def ending(problem: CycleOfEvents, origin: Sample, before: Sample | None) -> End | None:
    """The grazing or homoclinic orbit at or just beyond the last point of a family; None without a sign of one."""
    found = _new_event(problem, origin.z)
    if found is not None or before is None:
        return found
    places = problem, origin.z, before.z
    return saddle_node_end(*places) or homoclinic_end(*places) or _lost_event(*places)


def _new_event(problem: CycleOfEvents, z: Array) -> End | None:
    """The surface that an orbit touches without crossing it."""
    k, name = _touched(problem, z), problem.parameters[0]
    return None if k is None else _touching(problem, k, f"{name} = {z[-1]:.10g}", {name: float(z[-1])})


def _touching(problem: CycleOfEvents, k: int, where: str, at: Mapping[str, float]) -> End:
    text = f"at {where} the orbit touches the surface of {problem.flow.named(k)}"
    return End("grazing", f"{text}: beyond, it crosses it", {"at": dict(at), "event": k + 1})


def _touched(problem: CycleOfEvents, z: Array) -> int | None:
    """The event whose surface the orbit touches."""
    passage = problem.passage(z)
    if passage is None:
        return None
    flow, p = problem.flow, problem.inner.full_parameters(z)
    for k in range(len(flow.model.events)):
        heights = [flow.heights(k, arc_samples(problem, z, f), p) for f in passage.flown]
        range_ = float(np.ptp(np.concatenate(heights)))
        for flown, h in zip(passage.flown, heights, strict=True):
            inner = h[1:-1] if flown.arc.event == k else h
            if len(inner) > 2 and _clearance(inner) < TOUCHES * range_:
                return k
    return None


def _clearance(h: Array) -> float:
    """Smallest |h| at a turn of h inside; between samples by a parabola."""
    best = np.inf
    for i in range(1, len(h) - 1):
        a, b, c = abs(h[i - 1]), abs(h[i]), abs(h[i + 1])
        if b <= a and b <= c and h[i - 1] * h[i + 1] > 0.0:
            bend = a - 2.0 * b + c
            best = min(best, abs(b - (0.125 * elementary.square(c - a) / bend if bend > 0.0 else 0.0)))
    return best


def _lost_event(problem: CycleOfEvents, z: Array, before: Array) -> End | None:
    """The event of the cycle whose crossing becomes tangent, and where."""
    found, name = _lost((problem, z), (problem, before)), problem.parameters[0]
    if found is None:
        return None
    k, ahead, most = found
    rest = boundary_equilibrium_end(problem, z, before, k)
    if rest is not None:
        return rest
    at = float(z[-1] + ahead * (z[-1] - before[-1]))
    return _leaving(problem, k, f"{name} = {at:.8g}", {name: at}, most * abs(float(z[-1] - before[-1])))


def _leaving(problem: CycleOfEvents, k: int, where: str, at: Mapping[str, float], error: float) -> End:
    text = f"near {where} the orbit becomes tangent to the surface of {problem.flow.named(k)}"
    return End("grazing", f"{text}: beyond, the event does not come", {"at": dict(at), "event": k + 1, "error": error})


def _lost(now: tuple[CycleOfEvents, Array], before: tuple[CycleOfEvents, Array]) -> tuple[int, float, float] | None:
    """Of two orbits, the event whose crossing becomes tangent, and how many of their distances ahead: least and most.

    At least: where the square of its rate falls to zero with the distance, as it does where the jump is as large there
    as elsewhere. At most: where its rate does, as where the jump vanishes with it (an impact).
    """
    problem, z = now
    passages = problem.passage(z), before[0].passage(before[1])
    if passages[0] is None or passages[1] is None:
        return None
    for one, then in zip(passages[0].flown, passages[1].flown, strict=True):
        fallen = elementary.square(one.rate) - elementary.square(then.rate)
        if abs(one.rate) < TANGENT * usual_rate(problem, z, one) and fallen < 0.0:
            square = -elementary.square(one.rate) / fallen
            return one.arc.event, square, abs(one.rate) / (abs(then.rate) - abs(one.rate))
    return None


def curve_ending(
    now: tuple[CycleOfEvents, Array], before: tuple[CycleOfEvents, Array] | None, names: Sequence[str], place: Array,
    last: Array | None,
) -> End | None:  # fmt: skip
    """The grazing orbit at or just beyond the last point of a curve in two parameters; None without a sign of one.

    names, place, last : the parameters, their values at the last point, and at the one before it.
    """

    def said(at: Array) -> tuple[str, dict[str, float]]:
        values = dict(zip(names, at.tolist(), strict=True))
        return ", ".join(f"{name} = {value:.8g}" for name, value in values.items()), values

    k = _touched(*now)
    if k is not None:
        return _touching(now[0], k, *said(place))
    found = None if before is None else _lost(now, before)
    if found is None or last is None:
        return None
    k, ahead, most = found
    at = place + ahead * (place - last)
    return _leaving(now[0], k, *said(at), most * float(np.abs(place - last).max()))
