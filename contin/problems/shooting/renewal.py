"""After every chunk of a family found by shooting: does it end, does the metric fit, is the phase away from corners?"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.metric import measured_in
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.problems.orbits.ends import ends
from contin.problems.orbits.hopf_end import with_last_row
from contin.problems.shooting.equilibrium_on_surface import at_rest, has_shrunk
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.phase import onto_section, quietest, rebased, room
from contin.problems.shooting.unbounded_at_surface import comes_to_surface

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

CLOSE_TO_CORNER = 0.3  # of the best distance: nearer than this to a crossing, the phase is moved
LOST_SECTION = 0.7  # cosine between flow and normal below which the section is renewed
FAINT = 1e-6  # part of a unit tangent in parameter and period, below which its sign is rounding
BESIDE = 1e-4  # (scaled) distance of the neighbour that tells its sense then
TANGENT = 0.05  # ... below which the section is tangent to the flow
HALVINGS = 12  # of a step that leads beyond that


def renew(problem: ShotEquations, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame) -> Renewal:
    """Metric and phase for the next chunk, or the end of the branch."""
    found = _ending(problem, origin, before, frame)
    if found is not None:
        return found
    nodes = Nodes.of(origin.z, problem.n)
    sizes = problem.sizes(origin.z, frame.scale)
    largest = np.abs(nodes.u).max(axis=0)
    periods = np.asarray(problem.system.model.periods(problem.constants()), dtype=float)
    grown = np.where((periods == 0.0) & (largest > 1.3 * sizes), 1.3 * largest, sizes)
    period_at = len(origin.z) - problem.n - 3
    period = float(frame.scale[period_at])
    if nodes.period > period:
        period = 2.0 * nodes.period
    moves = problem.autonomous and misplaced(problem, origin.z, nodes, sizes)
    if not moves and np.array_equal(grown, sizes) and period == frame.scale[period_at]:
        return Renewal(frame.scale, origin, before, loop)
    scale = make_scale(grown, nodes.count, period, float(frame.scale[-1]))
    if not moves:
        kept, start = (None if s is None else measured_in(s, frame.scale, scale) for s in (before, loop))
        return Renewal(scale, measured_in(origin, frame.scale, scale), kept, start)
    fraction = quietest(problem, origin.z)
    moved = rebased(problem, origin.z, fraction, grown)
    target = Nodes.of(moved, problem.n)
    return Renewal(
        scale,
        _moved(problem, origin, moved, frame.scale, scale, fraction, target),
        None,
        None if loop is None else _moved(problem, loop, None, frame.scale, scale, fraction, target),
    )


def misplaced(problem: ShotEquations, z: Array, nodes: Nodes, sizes: Array) -> bool:
    """True where the first node is too close to a crossing, or its section too oblique to the flow."""
    oblique = obliqueness(problem, z, nodes, sizes) < LOST_SECTION
    return oblique or (problem.system.n_switches > 0 and room(problem, z) < CLOSE_TO_CORNER)


def obliqueness(problem: ShotEquations, z: Array, nodes: Nodes, sizes: Array) -> float:
    """Cosine between the flow and the section's normal at the first node, in scaled states."""
    velocity = problem.system.value(nodes.u[0], problem.full_parameters(z))
    speed = float(np.linalg.norm(velocity / sizes))
    return float(nodes.normal @ velocity) / (speed * float(np.linalg.norm(nodes.normal * sizes)) or 1.0)


def is_tangent(problem: ShotEquations, z: Array, scale: Array) -> bool:
    """True where the curve turns round in these unknowns, but the family of orbits does not."""
    return bool(
        problem.autonomous and abs(obliqueness(problem, z, Nodes.of(z, problem.n), problem.sizes(z, scale))) < TANGENT
    )


def cut_where_oblique(problem: ShotEquations, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """The chunk up to the first row whose section is too oblique: where it is tangent to the flow the curve turns round
    in these unknowns, and the family does not. A last step that leads beyond that place is shortened."""
    if not problem.autonomous:
        return chunk
    for row in range(1, len(chunk)):
        found = _obliqueness_at(problem, chunk.z[row], frame)
        if found < LOST_SECTION and row < len(chunk) - 1:
            return chunk.cut(row + 1, Stop.LIMIT, float(chunk.lengths[row]))
        if found < 0.0:
            return _before_tangent(problem, chunk, frame, settings)
    return chunk


def _before_tangent(problem: ShotEquations, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """The chunk with a last row whose section is oblique, but not yet tangent to the flow."""
    base, low, high = chunk.sample(len(chunk) - 2), 0.0, float(chunk.lengths[-1])
    for _ in range(HALVINGS):
        length = 0.5 * (low + high)
        found = problem.probe(base, length, base.z + length * frame.scale * base.tangent, frame, settings)
        slant = -1.0 if found is None else _obliqueness_at(problem, found.z, frame)
        if found is not None and TANGENT < slant < LOST_SECTION:
            return with_last_row(chunk.cut(len(chunk), Stop.LIMIT, length), found)
        low, high = (length, high) if slant >= LOST_SECTION else (low, length)
    return chunk


def _obliqueness_at(problem: ShotEquations, z: Array, frame: Frame) -> float:
    return obliqueness(problem, z, Nodes.of(z, problem.n), problem.sizes(z, frame.scale))


def _moved(
    problem: ShotEquations, sample: Sample, z: Array | None, old: Array, scale: Array, fraction: float, target: Nodes
) -> Sample:
    """A sample at the new phase; its tangent by solving for it there, with the sense of the old one."""
    at = onto_section(problem, sample.z, fraction, target) if z is None else z
    frame = Frame(scale)
    raw = sample.tangent * np.where(sample.tangent == 0.0, 0.0, old)
    guide = _parameter_and_period(problem, raw, scale)
    if float(np.linalg.norm(sample.tangent[[-1, len(raw) - problem.n - 3]])) < FAINT:
        guide = _of_neighbours(problem, sample.z, raw, at, scale, fraction, target)
    base = replace(sample, z=at, tangent=guide)
    found: Sample | None = problem.probe(base, 0.0, at, frame, Settings())
    if found is None:
        tangents = problem.tangents(at, scale)
        t = max(tangents, key=lambda v: abs(float(v @ guide)))
        return replace(sample, z=at, tangent=t * (np.sign(float(t @ guide)) or 1.0))
    t = found.tangent
    return replace(found, tangent=t * (np.sign(float(t @ guide)) or 1.0))


def _of_neighbours(
    problem: ShotEquations, z: Array, raw: Array, at: Array, scale: Array, fraction: float, target: Nodes
) -> Array:
    """A unit vector from an orbit to the next one of its family, both at the new phase: of a family at one parameter
    and period, as the cycles of a centre are, the rest of the tangent has no sense but this."""
    offset = (onto_section(problem, z + BESIDE * raw, fraction, target) - at) / scale
    size = float(np.linalg.norm(offset))
    return np.asarray(offset / size) if np.isfinite(size) and size > 0.0 else np.zeros(len(raw))


def _upright(problem: ShotEquations, origin: Sample, frame: Frame) -> Sample:
    """A small orbit from where its section is not oblique: others beside it are met there."""
    nodes, sizes = Nodes.of(origin.z, problem.n), problem.sizes(origin.z, frame.scale)
    if not has_shrunk(problem, origin.z, frame.scale) or not misplaced(problem, origin.z, nodes, sizes):
        return origin
    fraction = quietest(problem, origin.z)
    moved = rebased(problem, origin.z, fraction, sizes)
    return _moved(problem, origin, moved, frame.scale, frame.scale, fraction, Nodes.of(moved, problem.n))


def _parameter_and_period(problem: ShotEquations, raw: Array, scale: Array) -> Array:
    """The part of a raw direction that no change of phase touches, as a unit vector in the new metric."""
    guide = np.zeros(len(raw))
    for position in (-1, len(raw) - problem.n - 3):
        guide[position] = raw[position] / scale[position]
    size = float(np.linalg.norm(guide))
    return guide / size if size > 0.0 else guide


def _ending(problem: ShotEquations, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
    """The Hopf point that the family shrinks to, or the connecting orbit with which its period diverges."""
    if before is None or not problem.autonomous:
        return None
    sizes = problem.sizes(origin.z, frame.scale)
    profile, earlier = problem.profile(origin.z), problem.profile(before.z)
    if not np.all(np.isfinite(profile.u)):
        return None
    extent = float(np.max(np.ptp(profile.u, axis=0) / sizes))
    if extent < ends.SMALL and extent < float(np.max(np.ptp(earlier.u, axis=0) / sizes)):
        return _at_hopf_point(problem, origin, before, frame)
    resting = at_rest(problem, _upright(problem, origin, frame), before, frame)  # amplitude zero may lie between
    connected = None if resting is not None else ends.connected(problem, origin, before, frame)
    if connected is None:
        reached = None if resting is not None else comes_to_surface(problem, origin, frame)
        return resting if reached is None else Renewal(frame.scale, origin, before, None, reached)
    return Renewal(frame.scale, origin, before, None, connected.end, connected.last, connected.point)


def _at_hopf_point(problem: ShotEquations, origin: Sample, before: Sample, frame: Frame) -> Renewal | None:
    found = ends.shrunk(problem, origin, before, frame)
    if found is None:
        return at_rest(problem, _upright(problem, origin, frame), before, frame)
    last = found.last
    assert last is not None
    shape = problem.profile(origin.z)
    size = shape.u.size
    rest, period = last.z[: problem.n], float(last.z[size])
    nodes = Nodes.of(origin.z, problem.n)
    z = replace(
        nodes, u=np.tile(rest, (nodes.count, 1)), period=period, offset=float(nodes.normal @ rest),
        parameter=float(last.z[-1]),
    ).vector()  # fmt: skip
    end = End(found.end.reason, found.end.text, found.end.data)
    return Renewal(frame.scale, origin, before, None, end, replace(last, z=z), found.point)
