"""A whole branch: one start, up to two arms, joined into rows from the end of the down arm to the end of the up arm."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.arm import Arm, Piece
from contin.continuation.branch import Branch, End, Parent, SpecialPoint
from contin.continuation.curve import Stretch
from contin.continuation.isolate import Found, isolate
from contin.continuation.problem import Frame, Problem, Sample, Verified
from contin.continuation.rows import Rows
from contin.continuation.settings import Settings
from contin.continuation.targets import Target
from contin.errors import InputError, NotFiniteError

NEAR_START = 1e-3  # half-width, in steps, of the interval around a start that is searched for special points

Watcher = Callable[[Mapping[str, Any]], None]


@dataclass(frozen=True, eq=False)
class Seed:
    """Where a branch starts.

    `direction` and `scale` are given for branches born at a special point: the unit tangent there in scaled unknowns.
    `curvature` is the second-order term of the branch: z(s) = z + scale * (s direction + s^2 curvature / 2).
    `arms` are the senses to follow: -1 against, +1 along the direction (or the parameter, at an ordinary start).
    """

    problem: Problem
    z: Array
    direction: Array | None = None
    curvature: Array | None = None
    scale: Array | None = None
    arms: tuple[int, ...] = (-1, 1)
    parent: Parent | None = None
    symmetries: tuple[str, ...] = ()  # declared symmetries that map one half of the new branch onto the other

    @property
    def born(self) -> bool:
        return self.direction is not None


@dataclass(eq=False)
class _ArmRecord:
    """What one arm contributed, in its own order."""

    pieces: list[Piece]
    end: End
    accepted: int


def trace(
    seed: Seed,
    bounds: tuple[float, float],
    *,
    name: str = "branch",
    settings: Settings | None = None,
    targets: Sequence[Target] = (),
    watch: Watcher | None = None,
) -> Branch:
    """Follow the curve through `seed` in the senses of `seed.arms` and label what is found.

    Interrupting it (Ctrl-C) ends the branch with reason 'stopped'; everything computed is kept.
    """
    started = time.perf_counter()
    settings = settings or Settings()
    problem = seed.problem
    parameter = problem.parameters[0]
    if not bounds[0] < bounds[1]:
        raise InputError(f"range of {parameter}: the lower bound must be below the upper one; got {list(bounds)}")
    if not seed.born and not bounds[0] <= seed.z[-1] <= bounds[1]:
        raise InputError(f"the start has {parameter} = {seed.z[-1]:.10g}, outside the range [{bounds[0]:g}, {bounds[1]:g}]")
    scale = problem.initial_scale(seed.z, bounds) if seed.scale is None else seed.scale
    start, here = _first_sample(seed, scale, settings)
    records: dict[int, _ArmRecord] = {}
    known: list[Verified] = [f.point for f in here]
    if seed.born:  # the parent is not a label of the branch, should it come back to it
        known.append(Verified("BP", seed.z, 0.0, 0.0, start.eigenvalues, 0))
    notes: list[str] = []
    for sense in seed.arms:
        if -1 in records and records[-1].end.reason == "closed":
            records[sense] = _ArmRecord([], records[-1].end, 0)
            break
        origin = _origin(seed, start, sense, scale, settings, here)
        outward = _outward(seed, start, sense, bounds)
        if outward is not None:
            records[sense] = _ArmRecord([], outward, 0)
            continue
        if origin is None:
            text = f"no second point found from {parameter} = {seed.z[-1]:.10g}. {problem.describe_failure(seed.z)}"
            records[sense] = _ArmRecord([], End("corrector", text), 0)
            continue
        loop = _oriented(start, sense)
        arm = Arm(problem, origin, scale.copy(), bounds, settings, targets, loop, known, seed.symmetries)
        pieces: list[Piece] = []
        if seed.born:
            pieces.append(_single(origin, scale))
        try:
            for piece in arm.pieces():
                pieces.append(piece)
                notes.extend(piece.notes)
                if watch is not None:
                    watch(_progress(problem, piece, pieces, bounds, known))
        except KeyboardInterrupt:
            arm.end = End("stopped", f"stopped by the user at {parameter} = {pieces[-1].z[-1, -1] if pieces else start.z[-1]:.10g}")
        assert arm.end is not None
        records[sense] = _ArmRecord(pieces, arm.end, arm.accepted)
        if arm.end.reason == "stopped":
            break
    return _assemble(seed, start, here, records, name, settings, scale, bounds, targets, notes, started)


def _first_sample(seed: Seed, scale: Array, settings: Settings) -> tuple[Sample, list[Found]]:
    """The start with tangent and tests, and the special points that it coincides with."""
    problem = seed.problem
    if seed.born:
        assert seed.direction is not None
        empty = np.full(4, np.nan)
        return Sample(seed.z, seed.direction, empty, 0, np.empty(0, complex)), []
    tangents = problem.tangents(seed.z, scale)
    tangent = max(tangents, key=lambda t: abs(t[-1]))
    base = Sample(seed.z, _up(tangent), np.full(4, np.nan), 0, np.empty(0, complex))
    frame = Frame(scale)
    measured = problem.probe(base, 0.0, seed.z, frame, settings)
    if measured is not None and len(tangents) == 1:
        start = replace(measured, z=seed.z, tangent=_up(measured.tangent))
        if not _suspicious(start):
            return start, []
    width = NEAR_START * settings.first_step
    for _ in range(8):
        a = problem.probe(base, -width, seed.z - width * scale * base.tangent, frame, settings)
        b = problem.probe(base, width, seed.z + width * scale * base.tangent, frame, settings)
        if a is not None and b is not None:
            break
        width *= 4
    else:
        raise NotFiniteError(f"the branch cannot be followed from the start. {problem.describe_failure(seed.z)}")
    stretch = Stretch(problem, base, frame, settings)
    found = [item for item in isolate(stretch, a, b) if isinstance(item, Found)]
    return replace(b, z=seed.z, tangent=base.tangent), found


def _suspicious(start: Sample) -> bool:
    """A start at or next to a special point: look on both sides of it."""
    size = np.abs(start.eigenvalues)
    largest = float(size.max()) if size.size else 0.0
    return bool(
        abs(start.tangent[-1]) < 1e-3
        or np.any(np.abs(start.tests[2:]) < 1e-4)
        or (largest > 0 and float(np.abs(start.eigenvalues.real).min()) < 1e-4 * largest)
        or (largest == 0.0)
    )


def _up(tangent: Array) -> Array:
    """Oriented with the parameter; at a fold with the first unknown that moves."""
    leading = tangent[-1] if abs(tangent[-1]) > 1e-7 else tangent[np.flatnonzero(np.abs(tangent) > 1e-7)[0]]
    return tangent if leading > 0 else -tangent


def _oriented(sample: Sample, sense: int) -> Sample:
    if sense > 0:
        return sample
    tests = sample.tests.copy()
    tests[:2] *= -1.0  # dp/ds and det [J; t] turn with the tangent
    return replace(sample, tangent=-sample.tangent, tests=tests)


def _outward(seed: Seed, start: Sample, sense: int, bounds: tuple[float, float]) -> End | None:
    """An arm that would leave the range at once."""
    value = start.z[-1]
    rate = sense * start.tangent[-1]
    if (value >= bounds[1] and rate > 0) or (value <= bounds[0] and rate < 0):
        return End("bound", f"{seed.problem.parameters[0]} starts on its bound {value:.10g}", {"value": float(value)})
    return None


def _origin(
    seed: Seed, start: Sample, sense: int, scale: Array, settings: Settings, here: list[Found]
) -> Sample | None:
    """The sample an arm marches from: the start itself, or a point just off it where it is special."""
    problem, frame = seed.problem, Frame(scale)
    oriented = _oriented(start, sense)
    if not seed.born and not here:
        return oriented
    bend = np.zeros_like(scale) if seed.curvature is None else seed.curvature
    for size in settings.first_step * 10.0 ** -np.arange(1.0, 5.5, 0.5):
        guess = start.z + scale * (size * oriented.tangent + 0.5 * size**2 * bend)
        found = problem.probe(oriented, size, guess, frame, settings)
        if found is None:
            continue
        offset = (found.z - start.z) / scale
        if float(offset @ oriented.tangent) > 0.9 * float(np.linalg.norm(offset)) and found.tangent @ oriented.tangent > 0.8:
            return found
    return None


def _single(sample: Sample, scale: Array) -> Piece:
    return Piece(
        sample.z[None], sample.tangent[None], np.array([sample.unstable]), sample.eigenvalues[None], scale
    )


def _progress(
    problem: Problem, piece: Piece, pieces: list[Piece], bounds: tuple[float, float], known: list[Verified]
) -> dict[str, Any]:
    value = float(piece.z[-1, -1]) if len(piece.z) else float("nan")
    return {
        "parameter": problem.parameters[0],
        "value": value,
        "fraction": (value - bounds[0]) / (bounds[1] - bounds[0]),
        "rows": sum(len(p.z) for p in pieces),
        "labels": [k.type for k in known],
        "piece": piece,
    }


def _assemble(
    seed: Seed, start: Sample, here: list[Found], records: dict[int, _ArmRecord], name: str, settings: Settings,
    scale: Array, bounds: tuple[float, float], targets: Sequence[Target], notes: list[str], started: float,
) -> Branch:  # fmt: skip
    problem = seed.problem
    rows = Rows()
    if -1 in records:
        for piece in records[-1].pieces:
            rows.add_piece(piece)
        rows.reverse()
    start_row = len(rows)
    for item in here:
        rows.add_point(item.point, item.sample.tangent * scale, scale)
    if not here:
        count, values = _start_measured(seed, start, problem)
        rows.add_block(start.z[None], (start.tangent * scale)[None], np.array([count]), values[None])
        for target in targets:
            if not seed.born and float(target.values(problem, start.z[None])[0]) == target.value:
                rows.label(start_row, Verified("UZ", start.z, 0.0, 0.0, values, count), scale)
    if 1 in records:
        for piece in records[1].pieces:
            rows.add_piece(piece)
    z, raw_tangents, unstable, eigenvalues = rows.joined()
    columns: dict[str, Any] = dict(problem.columns(z))
    columns["unstable"] = unstable
    columns["stable"] = columns["unstable"] == 0
    points = _label(name, rows.labelled, columns, raw_tangents, problem)
    start_end = End("start", "the branch starts here" if not seed.born else f"born at {seed.parent.label if seed.parent else 'a special point'}")
    down, up = records.get(-1), records.get(1)
    ends = (down.end if down else start_end, up.end if up else start_end)
    if down is not None and down.end.reason == "stopped" and up is None and 1 in seed.arms:
        ends = (down.end, start_end)
    effort = {
        "evaluations": sum(p.evaluations for r in records.values() for p in r.pieces),
        "steps": sum(r.accepted for r in records.values()),
    }
    return Branch(
        name=name, kind=problem.kind, parameters=tuple(problem.parameters), columns=columns, points=points, ends=ends,
        z=z, tangents=raw_tangents, eigenvalues=eigenvalues, start_row=start_row,
        steps=effort["steps"], seconds=time.perf_counter() - started, effort=effort, problem=problem,
        locus=problem.locus, parent=seed.parent, notes=_distinct(notes), symmetries=seed.symmetries,
    )  # fmt: skip


def _distinct(notes: list[str]) -> tuple[str, ...]:
    """One note of each kind (the text before ' near '), with how often it was made."""
    kinds: dict[str, list[str]] = {}
    for note in notes:
        kinds.setdefault(note.split(" near ")[0], []).append(note)
    return tuple(same[0] if len(same) == 1 else f"{same[0]} and at {len(same) - 1} more places" for same in kinds.values())


def _start_measured(seed: Seed, start: Sample, problem: Problem) -> tuple[int, Any]:
    if not seed.born:
        return start.unstable, start.eigenvalues
    sample = problem.probe(start, 0.0, seed.z, Frame(np.ones_like(seed.z)), Settings())
    if sample is None:
        return 0, np.full(len(seed.z) - 1, np.nan, complex)
    critical = np.abs(sample.eigenvalues.real) < 1e-7 * max(float(np.abs(sample.eigenvalues).max()), 1e-300)
    return int(np.sum((sample.eigenvalues.real > 0) & ~critical)), sample.eigenvalues


def _label(
    branch: str, labelled: list[tuple[int, Verified, Array]], columns: dict[str, Any], tangents: Array, problem: Problem
) -> tuple[SpecialPoint, ...]:
    counts: dict[str, int] = {}
    points = []
    constants = problem.constants()
    for row, v, scale in sorted(labelled, key=lambda item: item[0]):
        counts[v.type] = counts.get(v.type, 0) + 1
        values = dict(constants)
        values.update({key: column[row].item() for key, column in columns.items()})
        points.append(
            SpecialPoint(
                type=v.type, label=f"{v.type}{counts[v.type]}", index=row, z=v.z, tangent=tangents[row], values=values,
                residual=v.residual, error=v.error, eigenvalues=v.eigenvalues, normal_form=v.normal_form,
                vectors=v.vectors, also=v.also, branch=branch, scale=scale, problem=problem,
            )  # fmt: skip
        )
    return tuple(points)
