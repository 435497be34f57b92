"""A whole branch: one start, up to two arms, joined into rows from the end of the down arm to the end of the up arm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.accounting import MET, needs_no_label, turns_again, unexplained, untold_turns
from contin.continuation.arm import Arm
from contin.continuation.at_start import found_at_start
from contin.continuation.both_ways import far_end, lies_between, meeting
from contin.continuation.branch import Branch, End, SpecialPoint
from contin.continuation.defects import contained
from contin.continuation.departure import Departure, depart
from contin.continuation.ends.asked import until_asked
from contin.continuation.ends.closed import until_closed
from contin.continuation.ends.domain import above_floors
from contin.continuation.ends.halved import until_halved
from contin.continuation.ends.jumping import until_jump
from contin.continuation.ends.reach import within_reach
from contin.continuation.ends.repeating import until_repeating
from contin.continuation.ends.retracing import until_retracing
from contin.continuation.ends.standing import until_standing
from contin.continuation.ends.unbounded import until_lost
from contin.continuation.gone_level import gone_level
from contin.continuation.gone_over import gone_over
from contin.continuation.gone_over_on_meshes import gone_over_on_meshes
from contin.continuation.journal import Journal, journaled
from contin.continuation.location.targets import Wanted
from contin.continuation.outcome import Verified
from contin.continuation.passed_twice import passed_twice_note
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.rows import Rows
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.segment import Segment
from contin.continuation.sentence import Sentence, distinct
from contin.continuation.settings import Settings
from contin.continuation.uncounted import uncounted, uncounted_note
from contin.errors import NoSolutionError, NotFiniteError
from contin.kernels.clock import computing_time
from contin.machine.freed import give_back
from contin.machine.one_thread import one_thread
from contin.records import Fields, Record

OVER: Final = (
    "the branch has gone over to another one beside it: where the two meet is not labelled, and what lies beyond on "
    "the first one is not followed"
)
NOISE: Final = 1e-12  # scaled: rounding of rows
TURNED: Final = "the parameter turns between two rows without a label: at a corner, or from one branch to another"
Watcher = Callable[[Record], None]


@dataclass(eq=False)
class _ArmRecord:
    """What one arm contributed, in its own order."""

    segments: list[Segment]
    end: End
    accepted: int


@one_thread
def trace(
    seed: Seed, bounds: tuple[float, float], *, name: str = "branch", settings: Settings | None = None,
    targets: Sequence[Wanted] = (), watch: Watcher | None = None, journal: Journal | None = None,
    deadline: float | None = None, most: int | None = None,
) -> Branch:  # fmt: skip
    """Follow the curve through `seed` in the senses of `seed.arms` and label what is found.

    most : accepted points of both arms together; `settings.steps` is of each.
    At the `deadline` (of `computing_time()`) an arm that is not over ends, with reason 'steps', after its chunk.
    `journal` keeps every chunk as it is computed, and answers with those of an earlier, killed run.
    Interrupting it (Ctrl-C) ends the branch with reason 'stopped'; everything computed is kept.
    """
    started, before = computing_time(), seed.problem.effort()
    departure = depart(seed, bounds, settings or Settings())
    seed = departure.seed
    records: dict[int, _ArmRecord] = {}
    notes = list(departure.notes)
    for sense in seed.arms:
        if -1 in records and records[-1].end.reason == "closed":
            records[sense] = _ArmRecord([], records[-1].end, 0)
            break
        march = None if journal is None else journaled(seed.problem.march, journal, f"{name}:{sense}")
        ready = departure.arm(sense, targets, march)
        if isinstance(ready, End):
            records[sense] = _ArmRecord([], ready, 0)
            continue
        arm, segments = ready
        if most is not None:
            arm.allow(most - sum(record.accepted for record in records.values()))
        far = _aims_at(records.get(-1), arm, departure)
        if isinstance(far, End):
            records[sense] = _ArmRecord([], far, 0)
            _end_both(records, far)
            break
        rows, first = sum(len(segment.z) for segment in segments), len(segments)
        try:
            for segment in until_defect(followed(arm, seed.z), arm):
                segments.append(segment)
                rows += len(segment.z)
                if watch is not None:
                    watch(_progress(seed.problem, segment, rows, bounds, departure.known))
                if deadline is not None and computing_time() > deadline and not arm.is_over():
                    arm.end = _out_of_time(seed, segments)
                    break
        except KeyboardInterrupt:
            arm.end = End("stopped", f"stopped by the user at {_position(seed, segments)}")
        assert arm.end is not None
        del segments[len(segments) - arm.retraced :]
        notes.extend(note for segment in segments[first:] for note in segment.notes)
        records[sense] = _ArmRecord(segments, arm.end, arm.accepted)
        if far is not None and arm.end.reason == "closed":
            _end_both(records, meeting(far, seed.problem.parameters[0]))
        if arm.end.defect:
            notes.append(Sentence(arm.end.text, defect=True))
        if arm.end.reason == "stopped":
            break
    branch = _assembled(departure, records, name, targets, notes, started, before)
    give_back()
    return branch


def _aims_at(other: _ArmRecord | None, arm: Arm, departure: Departure) -> Sample | End | None:
    """Where the other arm has used up its steps, which closes this one; or the end of both, where that is at once."""
    far = None if other is None else far_end(arm.problem, other.segments, other.end, arm.scale)
    if far is None:
        return None
    if lies_between(far, departure.start.z, arm.origin.z, arm.scale):
        return meeting(far, arm.problem.parameters[0])
    arm.loop = far
    return far


def _end_both(records: dict[int, _ArmRecord], end: End) -> None:
    for sense, record in records.items():
        records[sense] = replace(record, end=end)


def _assembled(
    departure: Departure, records: dict[int, _ArmRecord], name: str, targets: Sequence[Wanted], notes: list[Sentence],
    started: float, before: Mapping[str, int],
) -> Branch:  # fmt: skip
    try:
        return _assemble(departure, records, name, targets, [*notes], started, before)
    except KeyboardInterrupt:  # what is computed is not lost in its last moment; whoever watches the next run stops it
        return _assemble(departure, records, name, targets, [*notes], started, before)


def _out_of_time(seed: Seed, segments: list[Segment]) -> End:
    return End("steps", f"the time of the budget was used up at {_position(seed, segments)}; the branch may go on")


def _position(seed: Seed, segments: list[Segment]) -> str:
    last = next((segment.z[-1, -1] for segment in reversed(segments) if len(segment.z)), seed.z[-1])
    return f"{seed.problem.parameters[0]} = {last:.10g}"


def followed(arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm from `start` to its end: a bound, a floor, infinity, the start again."""
    smooth = until_asked(until_jump(arm.segments(), arm, start), arm)
    inside = within_reach(arm.problem, above_floors(arm.problem, smooth, arm, start), arm)
    inside = until_halved(inside, arm)
    whole = until_closed(until_lost(inside, arm, start), arm, start)
    return until_standing(until_retracing(until_repeating(whole, arm), arm), arm)


def until_defect(segments: Iterator[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments up to an error, foreseen by contin or not: it ends the arm, and loses none of them."""
    last = arm.origin.z

    def failed(text: str, defect: bool = True) -> None:
        arm.end = End("corrector", f"after {arm.course.position(last)}, {text}", defect=defect)

    while True:
        segment = None
        try:
            with contained(failed):
                segment = next(segments, None)
        except (NoSolutionError, NotFiniteError) as error:
            failed(str(error), defect=False)
        if segment is None:
            return
        last = segment.z[-1] if len(segment.z) else last
        yield segment


def _progress(
    problem: Problem, segment: Segment, rows: int, bounds: tuple[float, float], known: list[Verified]
) -> Fields:
    value = float(segment.z[-1, -1]) if len(segment.z) else float("nan")
    return {
        "parameter": problem.parameters[0],
        "value": value,
        "fraction": (value - bounds[0]) / (bounds[1] - bounds[0]),
        "rows": rows,
        "labels": [k.type for k in known],
        "segment": segment,
    }


def _assemble(
    departure: Departure, records: dict[int, _ArmRecord], name: str, targets: Sequence[Wanted], notes: list[Sentence],
    started: float, before: Mapping[str, int],
) -> Branch:  # fmt: skip
    seed, problem = departure.seed, departure.seed.problem
    rows = Rows()
    if -1 in records:
        for segment in records[-1].segments:
            rows.add_segment(segment, sense=-1.0)
        rows.reverse()
    start_row = _add_start(rows, departure, targets)
    if 1 in records:
        for segment in records[1].segments:
            rows.add_segment(segment)
    (z, raw_tangents, unstable, eigenvalues), start_row = rows.joined(start_row)
    columns: Fields = dict(problem.columns(z))
    properties: list[str] = []  # what holds all along the branch
    with contained(lambda text: notes.append(Sentence(text, defect=True))):
        properties.extend(problem.remarks(z, eigenvalues))
        notes += [Sentence(text) for text in (*properties, *problem.shortcomings(z, eigenvalues))]
        unstable = problem.recounted(z, unstable, eigenvalues)
    reasons = [record.end.reason if record else "" for record in (records.get(-1), records.get(1))]
    born = [start_row] if seed.born else []  # rows whose critical eigenvalues are not counted, as at labelled ones
    born += [row for row, reason in zip((0, len(z) - 1), reasons, strict=True) if reason in MET]
    again = [row for row, reason in zip((0, len(z) - 1), reasons, strict=True) if reason == "closed"]
    both = len(again) == 2 and 0 < start_row < len(z) - 1  # ways meet: the first row once more, else the start
    unstable[again] = unstable[0 if both else start_row]
    born += again if seed.born and not both else []
    told = in_two_parameters(problem) and bool(properties)  # critical eigenvalues that stay: their signs are rounding
    labels = [(row, point, float(raw_tangents[row, -1] / scale[-1])) for row, point, scale in rows.labelled]
    exact = problem.has_stability and eigenvalues.shape[1] > 0 and not problem.free_names
    exact &= problem.kind != "connection"  # of the saddle at its end: folds of connecting orbits do not change it
    everywhere = [] if told else unexplained(unstable, labels, born, (), exact)  # with those where equations jump
    changes = everywhere if told or not rows.jumps else unexplained(unstable, labels, born, rows.jumps, exact)
    changes = [row for row in changes if not needs_no_label(row, unstable, columns, labels)]
    unlabelled = sum(not needs_no_label(row, unstable, columns, labels) for row in everywhere)
    notes += [*_changes(changes, unstable, z, problem), *unrecorded(columns, z, problem)]
    special = {*born, *(row for row, *_ in labels)}
    unknown = uncounted(eigenvalues, special) if exact else []
    untold = _astray(departure, z, columns, raw_tangents, labels, start_row, (born, rows.jumps))
    untold += [Sentence(text) for text in uncounted_note(unknown, columns, problem.parameters[0], len(z))]
    untold += passed_twice_note(problem, eigenvalues, z, special) if exact else []
    notes += [*_remarks(rows.labelled, problem), *untold, *_guessed(departure, columns)]
    if problem.has_stability:
        columns["unstable"] = unstable
        columns["stable"] = (unstable == 0) & ~np.isin(np.arange(len(unstable)), unknown)
    if len(problem.finite(z[0], eigenvalues[0])) < eigenvalues.shape[1]:  # of as many equations in every row
        eigenvalues = np.array([problem.finite(*row) for row in zip(z, eigenvalues, strict=True)])
    effort = _effort(records, problem, before)
    texts, defects = distinct(notes)
    return Branch(
        name=name, kind=problem.kind, parameters=tuple(problem.parameters), columns=columns,
        points=_label(name, rows.labelled, columns, raw_tangents, problem), ends=_ends(seed, records),
        z=z, tangents=raw_tangents, eigenvalues=eigenvalues, start_row=start_row, steps=effort["steps"],
        seconds=computing_time() - started, effort=effort, problem=problem, locus=problem.locus,
        free=problem.free_names, parent=seed.parent, notes=texts, symmetries=seed.symmetries, defects=defects,
        jumped=max(unlabelled - len(changes), 0),
        unexplained=len(changes) + len(untold) + sum(p.hiding for r in records.values() for p in r.segments),
    )  # fmt: skip


def _guessed(departure: Departure, columns: Record) -> list[Sentence]:
    """A note for states that move, of which nothing says how large they are."""
    seed, problem = departure.seed, departure.seed.problem
    names = problem.guessed(seed.z, departure.bounds) if seed.scale is None else ()
    moving = [name for name in names if np.any(columns[name])]
    return [Sentence(problem.guess_note(moving))] if moving else []


def _astray(
    departure: Departure, z: Array, columns: Record, tangents: Array, labels: list[tuple[int, Verified, float]],
    start: int, special: tuple[list[int], list[int]],
) -> list[Sentence]:  # fmt: skip
    """A note for every step that has led over to another branch, or round a corner, without a label.

    special : rows at special points of other branches, and at corners.
    """
    problem, scale, bounds = departure.seed.problem, departure.scale, departure.bounds
    if departure.seed.passing or in_two_parameters(problem):
        return []
    born, jumps = special
    if problem.adaptive and problem.kind != "orbit" and not problem.has_shared_places:
        return []  # how far end values depend on the mesh is unknown
    if problem.adaptive:
        over: list[int] = []
        errors: list[Sentence] = []
        known = {*born, *(row for row, _, _ in labels)}
        with contained(lambda text: errors.append(Sentence(text, defect=True))):
            if problem.has_shared_places:
                over = gone_over_on_meshes(problem, z, tangents, start, known, bounds)
            else:
                over = gone_level(problem, z, columns, start, known, bounds)
        return [*errors, *(Sentence.near(problem, z[row], OVER, f" (row {row})") for row in over)]
    turns = untold_turns(tangents[:, -1] / scale[-1], labels, [*jumps, *born])
    turns = [row for row in turns if not turns_again(row, columns, labels)]
    over = gone_over(problem, z, tangents, start, {*born, *(row for row, _, _ in labels)}, scale, NOISE)
    places = [*((TURNED, row) for row in turns), *((OVER, row) for row in over)]
    return [Sentence.near(problem, z[row], text, f" (row {row})") for text, row in places]


def _effort(records: dict[int, _ArmRecord], problem: Problem, before: Mapping[str, int]) -> dict[str, int]:
    return {
        "evaluations": sum(p.evaluations for r in records.values() for p in r.segments),
        "steps": sum(r.accepted for r in records.values()),
        **{name: count - before.get(name, 0) for name, count in problem.effort().items()},
    }


def _add_start(rows: Rows, departure: Departure, targets: Sequence[Wanted]) -> int:
    """Add the row that both arms leave, with what is labelled there, and return its place."""
    here, scale = found_at_start(departure, targets), departure.scale
    before = 0 if departure.here else sum(item.length < 0.0 for item in here)
    place = len(rows) + before
    for item in here[:before]:
        rows.add_point(item.point, item.sample.tangent * scale, scale)
    if not departure.here:
        _add_row(rows, departure)
    for item in here[before:]:
        rows.add_point(item.point, item.sample.tangent * scale, scale)
    return place


def _add_row(rows: Rows, departure: Departure) -> None:
    """An ordinary start."""
    start = departure.start
    count, values = _start_measured(departure.seed, start, departure.seed.problem)
    rows.add_block(start.z[None], (start.tangent * departure.scale)[None], np.array([count]), values[None])


def _ends(seed: Seed, records: dict[int, _ArmRecord]) -> tuple[End, End]:
    """Of the first row and the last: an arm's end, or the start."""
    born = f"born at {seed.parent.label if seed.parent else 'a special point'}"
    start = End("start", born if seed.born else "the branch starts here")
    down, up = records.get(-1), records.get(1)
    return down.end if down else start, up.end if up else start


def _remarks(labelled: list[tuple[int, Verified, Array]], problem: Problem) -> list[Sentence]:
    """What could not be told about labelled points, with their places."""
    return [Sentence.near(problem, v.z, v.remark) for _, v, _ in labelled if v.remark]


def _changes(rows: list[int], unstable: NDArray[np.int64], z: Array, problem: Problem) -> list[Sentence]:
    """A note for every change of `unstable` that no label explains."""
    notes = []
    for row in rows:
        before, after = unstable[row - 1], unstable[row]
        text = f"unstable changes from {before} to {after} without a label that explains it"
        if before == after:
            text = f"unstable is {after} beyond labelled points that change it to another number: one may be missing"
        notes.append(Sentence.near(problem, z[row], text, f" (row {row})"))
    return notes


def unrecorded(columns: Record, z: Array, problem: Problem) -> list[Sentence]:
    """A note for every column without a value on some rows: an observable that is not defined there, or that failed."""
    notes = []
    for name, column in columns.items():
        finite = np.isfinite(column)
        if finite.all():
            continue
        bad = np.flatnonzero(~finite)
        row = int(bad[0])
        where = ", ".join(f"{p} = {columns[p][row]:.6g}" for p in problem.parameters if p in columns and p != name)
        reason = problem.explain_columns(z[row])
        first = f"first at {where}" if where else f"first in row {row}"
        text = f"{name} has no value in {bad.size} of {len(column)} rows, {first}"
        notes.append(Sentence(text + (f": {reason}" if reason else "")))
    return notes


def _start_measured(seed: Seed, start: Sample, problem: Problem) -> tuple[int, NDArray[np.complex128]]:
    if not seed.born:
        return start.unstable, start.eigenvalues
    if seed.measured is not None:
        return seed.measured
    sample = problem.probe(start, 0.0, seed.z, Frame(np.ones_like(seed.z)), Settings())
    if sample is None:
        return 0, np.empty(0, complex)  # rows are as wide as those beside
    critical = np.abs(sample.eigenvalues.real) < 1e-7 * float(np.abs(sample.eigenvalues).max(initial=1e-300))
    return int(np.sum((sample.eigenvalues.real > 0) & ~critical)), sample.eigenvalues


def _label(
    branch: str, labelled: list[tuple[int, Verified, Array]], columns: Fields, tangents: Array, problem: Problem
) -> tuple[SpecialPoint, ...]:
    counts: dict[str, int] = {}
    points = []
    constants = problem.constants()
    for row, v, scale in sorted(labelled, key=lambda item: item[0]):
        counts[v.type] = counts.get(v.type, 0) + 1
        values = dict(constants)
        values.update({key: column[row].item() for key, column in columns.items()})
        alone, z, tangent, metric = problem.alone(v.z, tangents[row, -len(v.z) :], scale)
        points.append(
            SpecialPoint(
                type=v.type,
                label=f"{v.type}{counts[v.type]}",
                index=row,
                z=z,
                tangent=tangent,
                values=values,
                residual=float(v.residual),
                error=float(v.error),
                eigenvalues=problem.finite(v.z, v.eigenvalues),
                normal_form=v.normal_form,
                vectors=v.vectors,
                also=v.also,
                branch=branch,
                scale=metric,
                problem=alone,
            )
        )
    return tuple(points)
