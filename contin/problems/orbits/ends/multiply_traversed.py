"""Families that have slipped onto one of half (a third of) the period, whose orbits they run through twice (thrice).

Beside its birth and its end a doubled family is as near to the orbits it leaves as its amplitude, and a corrector may
fall onto these. Doubled orbits of their own move by ds with a difference of their halves that changes by about ds;
where the halves agree and go on to do so, they are the known orbits. The step is then repeated, shorter, and where no
step helps the branch ends as joined.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.sample import Chunk, Stop
from contin.problems.orbits.mesh.layout import Profile, Transfer

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

PARTS: Final = (2, 3)  # half and a third of the period
SAMPLES: Final = 60  # times in a period at which orbits are compared first; then at those of the mesh, too
FIRST: Final = slice(SAMPLES // 3, SAMPLES // 3 + 2)  # of these: most orbits need no more to be told from their parts
EQUAL: Final = 1e-4  # of the extent: parts that differ by less may be the same
STANDING: Final = 1e-2  # ... if in a step their difference changes by less than this part of its (scaled) length
SHORTER: Final = 0.1  # the repeated step beside the one that slipped
SHORTEST: Final = 1e-5  # scaled; no shorter step is tried


def parts_apart(profile: Profile, winding: Array, times: Array, parts: int) -> Array:
    """u(x + 1/parts) - u(x), relative to the extent of the orbit, (k, n), at times (2, k)."""
    later, now = np.split(profile.at(times.ravel()), 2)
    return np.asarray((later - now - winding / parts) / _extent(profile.u, winding))


def _extent(u: Array, winding: Array) -> float:
    """The largest of an orbit's extents (nodes, n), and of what it gains in a period."""
    across = u.T
    extents = np.maximum(across.max(axis=1) - across.min(axis=1), np.abs(winding))
    return max(float(extents.max()), float(np.finfo(float).tiny))


@cache
def _times(parts: int) -> Array:
    """Times to compare, later and earlier ones, (2, `SAMPLES`)."""
    earlier = np.linspace(0.0, 1.0 - 1.0 / parts, SAMPLES)
    return np.stack([earlier + 1.0 / parts, earlier])


def _times_on(mesh: Array, parts: int) -> Array:
    """`_times`, and those at which one or the other is a point of the mesh: a pulse is short beside a long period."""
    shift = 1.0 / parts
    earlier = np.concatenate([mesh[mesh <= 1.0 - shift], np.maximum(mesh[mesh >= shift] - shift, 0.0)])
    return np.concatenate([_times(parts), np.stack([np.minimum(earlier + shift, 1.0), earlier])], axis=1)


@cache
def _first_times() -> Array:
    """Of both `PARTS` those that most orbits need to be told from their parts, (2, 2 * `FIRST`)."""
    return np.concatenate([_times(parts)[:, FIRST] for parts in PARTS], axis=1)


@lru_cache(maxsize=16)
def _first_look(m: int, h: bytes) -> Transfer:
    """To these times, from the nodes of a mesh: most orbits in turn are on one."""
    return Transfer.to_times(m, np.frombuffer(h), _first_times().ravel())


@lru_cache(maxsize=4)
def _equal_at_first(m: int, n: int, u: bytes, h: bytes, winding: bytes) -> tuple[int, ...]:
    """Of `PARTS` those that an orbit may run through: at the first times nothing tells it from its parts.

    The same orbit is asked for by the march that comes to it and by the look for its end.
    """
    nodes, gain = np.frombuffer(u).reshape(-1, n), np.frombuffer(winding)
    values = _first_look(m, h)(nodes)
    half = len(values) // 2
    gaps, limit, each = values[:half] - values[half:], EQUAL * _extent(nodes, gain), half // len(PARTS)
    return tuple(
        parts for k, parts in enumerate(PARTS) if np.abs(gaps[k * each : (k + 1) * each] - gain / parts).max() < limit
    )


def times_traversed(problem: OrbitEquations, z: Array, before: Array, step: float) -> int:
    """How often the orbit z, a step of this scaled length after `before`, runs through another one (1: it does not)."""
    possible = [parts for parts in PARTS if problem.autonomous or problem.multiple % parts == 0]
    winding = np.asarray(problem.winding, dtype=float)
    if winding.any():  # a part of it must be a whole number of turns of every angle
        angles = problem.state_periods[: len(winding)]
        possible = [parts for parts in possible if _are_whole(winding[winding != 0.0] / parts, angles[winding != 0.0])]
    if not possible:
        return 1
    orbit = problem.profile(z)
    near = _equal_at_first(orbit.m, orbit.n, orbit.u.tobytes(), orbit.h.tobytes(), winding.tobytes())
    for parts in near:
        if parts not in possible:
            continue
        times = _times_on(orbit.mesh, parts)
        here = parts_apart(orbit, winding, times, parts)
        if not np.abs(here).max() < EQUAL:
            continue
        change = here - parts_apart(problem.profile(before), winding, times, parts)
        if np.abs(change).max() < STANDING * step:
            return parts
    return 1


def _are_whole(gains: Array, periods: Array) -> bool:
    """True where every angle gains a multiple of its period."""
    turns = gains / periods
    return bool(np.all(np.abs(turns - np.round(turns)) < 1e-6))


def cut_where_traversed(problem: OrbitEquations, chunk: Chunk) -> Chunk:
    """The chunk before the row at which it slips, to go on with a shorter step; with that row where none helps."""

    def slipped(row: int) -> bool:
        return times_traversed(problem, chunk.z[row], chunk.z[row - 1], float(chunk.lengths[row])) > 1

    last = len(chunk) - 1
    if last < 1 or not slipped(last):
        return chunk
    first = next(row for row in range(1, last + 1) if slipped(row))
    step = SHORTER * float(chunk.lengths[first])
    return chunk.cut(first if step > SHORTEST else first + 1, Stop.LIMIT, max(step, SHORTEST))


def joined(problem: OrbitEquations, z: Array, before: Array, scale: Array) -> End | None:
    """The end of a family at an orbit (z, its row before) that is another one run through several times."""
    if z.size != before.size:
        return None
    count = times_traversed(problem, z, before, float(np.linalg.norm((z - before) / scale)))
    if count == 1:
        return None
    period = problem.profile(z).period
    text = (
        f"joined a known family at {problem.parameters[0]} = {z[-1]:.10g}: the orbits run {count} times through those "
        f"of period {period / count:.8g}"
    )
    return End("joined", text, {"value": float(z[-1]), "times": count})
