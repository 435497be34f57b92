"""`contin survey`: which parameters matter. From each attractor one short continuation in each parameter, both ways."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_all_start_methods, get_context
from typing import TYPE_CHECKING, Any, Final, Protocol

from contin import lazy
from contin.api.attractors import MOST, attractors
from contin.api.auto_start import is_singular
from contin.api.fixed_totals import varying
from contin.api.found_start import FoundStart
from contin.api.survey_side import Side, follow
from contin.errors import InputError
from contin.model.advice import place_of_parameter
from contin.model.expression import symbols_in
from contin.model.kinds import need_model
from contin.model.model import Model
from contin.plot.survey import drawn
from contin.records import Fields, Record
from contin.symbolic.passes.conserved import conserved_notes
from contin.symbolic.passes.translations import translation_notes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FACTOR: Final = 10.0
Watch = Callable[[int, int], None]


@dataclass(frozen=True)
class Row:
    """One parameter, from one attractor: `below` is the arm towards value/factor, `above` that towards value*factor."""

    attractor: str
    parameter: str
    value: float
    below: Side
    above: Side

    @property
    def margin(self) -> float:
        """The factor by which the parameter may change before something happens; infinite where nothing does."""
        sides = [s for s in (self.below, self.above) if s.type]
        ratios = [abs(s.at / self.value) if self.value else 0.0 for s in sides]
        return min((max(r, 1.0 / r) if r > 0.0 else float("inf") for r in ratios), default=float("inf"))


class Attractor(Protocol):
    """What a survey started from: a `FoundStart`, or one from a file in words."""

    @property
    def solution(self) -> object: ...

    @property
    def how(self) -> str: ...

    @property
    def words(self) -> str: ...


@dataclass(frozen=True, eq=False, repr=False)
class Survey:
    """Rows sorted by attractor, then by how soon something happens; `attractors` are the starts, by name."""

    model: str
    attractors: Mapping[str, Attractor]
    rows: tuple[Row, ...]
    factor: float
    notes: tuple[str, ...]
    seconds: float

    @property
    def columns(self) -> Fields:
        """One list a column: attractor, parameter, value, and of each side where it ends, the type and its detail."""
        found: Fields = {
            "attractor": [r.attractor for r in self.rows], "parameter": [r.parameter for r in self.rows],
            "value": [r.value for r in self.rows],
        }  # fmt: skip
        for name in ("below", "above"):
            sides: list[Side] = [getattr(r, name) for r in self.rows]
            found |= {
                name: [s.at for s in sides], f"{name}.type": [s.type for s in sides],
                f"{name}.detail": [s.detail for s in sides], f"{name}.end": [s.reason for s in sides],
            }  # fmt: skip
        return found

    def document(self) -> Fields:
        """The survey as plain data."""
        return {
            "contin": 1, "model": self.model, "factor": self.factor, "survey": self.columns,
            "attractors": {
                name: {"solution": str(found.solution), "how": found.how, "words": found.words}
                for name, found in self.attractors.items()
            },
            "notes": list(self.notes), "seconds": self.seconds,
        }  # fmt: skip

    def plot(self, attractor: str | None = None, *, ax: Axes | None = None, **options: object) -> Figure:
        """Bars over the ratio to the parameter's value, one panel an attractor (a matplotlib figure).

        attractor : draw this one alone.  ax : draw it into these axes instead.
        options : y (the parameters to show), labels, limits of `ratio`, size, legend, title, style (`contin.draw`).
        """
        return drawn(self.document(), ax, options, attractor)

    def __repr__(self) -> str:
        return f"<Survey of {self.model!r}: {len(self.rows)} rows, {len(self.attractors)} attractors>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook trajectories").survey_page(self))

    def __str__(self) -> str:
        lines = [f"{self.model}: {len(self.rows)} rows, {self.seconds:.1f} s"]
        for name, found in self.attractors.items():
            lines += ["", f"{name}: {found}"]
            lines += [f"  {r.parameter:<16} {r.value:<12.6g} {said(r.below):<34} {said(r.above)}"
                      for r in self.rows if r.attractor == name]  # fmt: skip
        return "\n".join([*lines, *(["", "notes:"] if self.notes else []), *(f"  {note}" for note in self.notes)])


def said(side: Side) -> str:
    """One end of a row in words."""
    if side.type:
        return f"{side.type} at {side.at:.6g}{f' ({side.detail})' if side.detail else ''}"
    return f"none to {side.at:.6g}" + ("" if side.reason == "bound" else f" [{side.reason}]")


def survey(
    model: Any, parameters: Record | None = None, *, names: Sequence[str] = (), starts: Sequence[Any] = (),
    factor: float = FACTOR, most: int = MOST, processes: int | None = None, watch: Watch | None = None,
) -> Survey:  # fmt: skip
    """Follow each attractor in each parameter over [1/factor, factor] times its value, to the first bifurcation.

    names : the parameters (default: all that the equations depend on).  starts : where attractors are looked for (see
    `contin.api.attractors`).  A parameter that is 0 is followed over the range that the model declares for it, if any.
    processes : that share the work; default one a core.  watch : called with (arms done, arms in all).

    Raises NoSolutionError where no attractor is found.
    """
    need_model(model)
    began = time.perf_counter()
    if not factor > 1.0:
        raise InputError(f"factor must be above 1; got {factor!r}")
    started = attractors(model, parameters, tuple(starts), most)
    system = started.found[0].system
    model, known = system.model, varying(system.parameter_names)
    for name in names:
        place_of_parameter(name, known)
    found = {_name(one, k, len(started.found)): one for k, one in enumerate(started.found)}
    values = dict(zip(system.parameter_names, started.found[0].solution.p.tolist(), strict=True))
    notes = [*conserved_notes(model), *started.notes]
    spans = dict(_spans(model, parameters, list(names) or known, values, factor, notes))
    followed = [name for name, one in found.items() if not is_singular(one)]
    notes += [f"{name}: {_why_not(model)}" for name in found if name not in followed]
    jobs = [
        _Job(attractor, name, values[name], far)
        for attractor in followed for name, ends in spans.items() for far in ends
    ]  # fmt: skip
    sides = _carry_out({name: one.solution for name, one in found.items()}, jobs, processes, watch)
    rows = [
        Row(attractor, name, values[name], *(sides[_Job(attractor, name, values[name], far)] for far in ends))
        for attractor in followed for name, ends in spans.items()
    ]  # fmt: skip
    order = list(found)
    rows.sort(key=lambda r: (order.index(r.attractor), r.margin))
    notes += [
        f"{r.attractor}, {r.parameter}: {s.text}" for r in rows for s in (r.below, r.above) if not s.complete and s.text
    ]
    return Survey(model.name, found, tuple(rows), factor, tuple(notes), time.perf_counter() - began)


def _why_not(model: Any) -> str:
    """Why an equilibrium that is not isolated has no branches."""
    reasons = translation_notes(model) or ["it is one of a line of them, or stands exactly at a bifurcation"]
    return f"the Jacobian is singular here, so it is not followed: {'; '.join(reasons)}"


def _name(one: FoundStart, k: int, count: int) -> str:
    kind = "cycle" if hasattr(one.solution, "period") else "rest"
    return kind if count == 1 else f"{kind}{k + 1}"


def _spans(
    model: Any, parameters: Record | None, names: Sequence[str], values: dict[str, float], factor: float,
    notes: list[str],
) -> Iterator[tuple[str, tuple[float, float]]]:  # fmt: skip
    """(name, (towards smaller modulus, towards larger)) of the parameters that can be followed."""
    used = _used(model)
    for name in names:
        value = values[name]
        declared = model.parameter_range(name, {n: v for n, v in (parameters or {}).items() if n in values})
        if used is not None and name not in used:
            notes.append(f"{name}: the equations do not depend on it")
        elif value != 0.0:
            yield name, (value / factor, value * factor)
        elif declared is not None and declared[0] <= 0.0 <= declared[1]:
            yield name, declared
        else:
            notes.append(f"{name} is 0, and has no range around it: not followed")


def _used(model: Any) -> set[str] | None:
    """Names that occur in the equations of a model of formulas."""
    if not isinstance(model, Model):
        return None
    return set(symbols_in([*model.equations, *(p.value for p in model.parameters)]))


@dataclass(frozen=True)
class _Job:
    attractor: str
    parameter: str
    value: float
    far: float


_shared: dict[str, Any] = {}  # in a process of the pool: the attractors by name


def _carry_out(
    solutions: dict[str, Any], jobs: Sequence[_Job], processes: int | None, watch: Watch | None
) -> dict[_Job, Side]:
    """Every job's side; one of each attractor first, so that kernels are there before the processes start."""
    found: dict[_Job, Side] = {}

    def done(job: _Job, side: Side) -> None:
        found[job] = side
        if watch is not None:
            watch(len(found), len(jobs))

    _shared.clear()
    _shared.update(solutions)
    first = list({j.attractor: j for j in reversed(jobs)}.values())
    for job in first:
        done(job, _do(job))
    left = [j for j in jobs if j not in found]
    count = min(processes or _cores(), len(left))
    if count <= 1 or "fork" not in get_all_start_methods():  # elsewhere each process would compile everything anew
        for job in left:
            done(job, _do(job))
        return found
    with ProcessPoolExecutor(count, mp_context=get_context("fork")) as pool:
        try:
            waiting = {pool.submit(_do, job): job for job in left}
            for future in as_completed(waiting):
                done(waiting[future], future.result())
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return found


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _do(job: _Job) -> Side:
    return follow(_shared[job.attractor], job.parameter, job.value, job.far)
