"""`contin run` and `contin diagram`: plan, compute, report, write."""

from __future__ import annotations

import math
import sys
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from contin import lazy
from contin.cli.commands import imported
from contin.cli.drawer import drawer_of
from contin.cli.interrupt import check, hold
from contin.cli.look_options import written_look
from contin.cli.outputs import CUT_SHORT, DONE, outputs_of, provenance, report_on, writable, write_all
from contin.cli.terminal import console
from contin.cli.ticker import Ticker, duration
from contin.cli.told import Told
from contin.continuation.kept_rows import kept_rows
from contin.errors import InputError
from contin.kernels.clock import CLOCK
from contin.machine.progress import telling
from contin.model.source import CallSource
from contin.plot.rows import rows_of
from contin.plot.write import PAGES
from contin.records import Fields, Record
from contin.runs.bundled import find_run, is_scan
from contin.runs.engine import ContinEngine
from contin.runs.execute import execute
from contin.runs.foreign import foreign_run, is_foreign
from contin.runs.load import load_run_file, read_run
from contin.runs.outputs import ENDINGS, files_read, make_folder
from contin.runs.plan import make_plan
from contin.runs.results import OrbitSamples
from contin.runs.simulated import Simulated
from contin.store.atomic import is_special
from contin.store.digest import DamageWarning
from contin.store.journal import SqliteJournal, fingerprint
from contin.store.json_format import describe_model, plain, result_document
from contin.store.partial import PartialJson
from contin.store.solutions import Solutions, solutions_of

if TYPE_CHECKING:
    from rich.console import Console

    from contin.continuation.branch import Branch
    from contin.machine.progress import Progress
    from contin.runs.plans import Plan
    from contin.store.journal import SqliteJournal
    from contin.store.partial import PartialJson


def run_file(
    file: Path, json: str | None, sets: Sequence[str], orbits: bool, quiet: bool, began: float, resume: bool = False
) -> int:
    """Carry out a run file, or a bundled one by its name; the exit code."""
    file, place = find_run(file)
    overrides = parse_sets(sets)
    if is_foreign(file):
        entry, source = foreign_run(file)
        return carry_out(make_plan(entry, source, place, overrides), json, orbits, quiet, began, resume)
    if is_scan(file):
        code: int = lazy.module("scan").scan_file(file, json, sets, None, None, resume, None, quiet, place)
        return code
    entry, source = load_run_file(file)
    plan = make_plan(entry, source, place, overrides)
    return carry_out(plan, json, orbits, quiet, began, resume, files_read(entry, file))


def run_diagram(
    model: str,
    diagram: Record,
    given: Mapping[str, Sequence[str]],
    sets: Sequence[str],
    json: str | None,
    files: Mapping[str, Path | None],
    orbits: bool,
    quiet: bool,
    began: float,
    look: Record,
) -> int:
    """Explore a diagram from the command line: the same as a run file with `diagram:`.

    given : NAME=VALUE texts of `budget` and `settings`.  files : outputs by kind.  look : options of the picture.
    """
    shown = written_look(look, look.get("x"), look.get("y"))
    written = {key: parse_pairs(f"--{key}", texts) for key, texts in given.items() if texts}
    outputs = _asked_for(files)
    source = CallSource("contin diagram")
    axes = {key: shown[key] for key in ("x", "y") if key in shown}
    asked = {"model": model, "diagram": {**diagram, **written}, "outputs": axes}
    entry = read_run(asked, source, version_required=False)
    plan = make_plan(entry, source, Path.cwd() / "command line", parse_sets(sets))
    return carry_out(replace(plan, outputs=outputs, look=shown), json, orbits, quiet, began, told=True)


def run_phase(
    model: str,
    parameters: tuple[str, str],
    ranges: tuple[tuple[float, float], tuple[float, float]],
    starts: Sequence[str],
    sets: Sequence[str],
    json: str | None,
    files: Mapping[str, Path | None],
    orbits: bool,
    quiet: bool,
    began: float,
    look: Record,
) -> int:
    """A phase diagram from the command line: the same as a run file with `phase:`.  files : outputs by kind."""
    shown = written_look(look, None, None)
    outputs = _asked_for(files)
    bounds = {name: list(pair) for name, pair in zip(parameters, ranges, strict=True)}
    chosen = {"start": list(starts)} if starts else {}
    phase = {"parameter": list(parameters), "range": bounds, "orbits": orbits, **chosen}
    source = CallSource("contin phase")
    entry = read_run({"model": model, "phase": phase}, source, version_required=False)
    plan = make_plan(entry, source, Path.cwd() / "command line", parse_sets(sets))
    return carry_out(replace(plan, outputs=outputs, look=shown), json, False, quiet, began)


def _asked_for(files: Mapping[str, Path | None]) -> dict[str, Path]:
    """The files that options name, by kind; InputError where one has another ending."""
    outputs = {kind: path for kind, path in files.items() if path is not None}
    for kind, path in outputs.items():
        if path.suffix.lower() not in ENDINGS[kind]:
            raise InputError(f"--{kind} {path}: must end in {' or '.join(ENDINGS[kind])}")
    return outputs


EXAMPLES: Final = {"--set": "beta=0.8", "--budget": "branches=20", "--settings": "max_step=0.1", "--at": "z=1"}


def parse_sets(sets: Sequence[str]) -> Fields:
    """--set NAME=VALUE, as overrides; a value may be a formula in the parameters."""
    pairs = parse_pairs("--set", sets)
    return {name: value if isinstance(value, str) else float(value) for name, value in pairs.items()}


def parse_pairs(option: str, texts: Sequence[str]) -> Fields:
    """NAME=VALUE texts of an option: numbers where they are some, else texts."""
    found: Fields = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} {text}: write {option} NAME=VALUE, such as {option} {EXAMPLES[option]}")
        found[name] = _number_or_text(value)
    return found


def _number_or_text(value: str) -> float | str:
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return value


def carry_out(
    plan: Plan, json: str | None, orbits: bool, quiet: bool, began: float, resume: bool = False,
    read: Sequence[Path] = (), told: bool = False,
) -> int:  # fmt: skip
    """Compute the plan, write its outputs and report it; the exit code.

    `read`: files that no output may overwrite.  `told`: each branch gets a line on standard error when it is done.
    """
    errors = console(sys.stderr, quiet)
    report = errors if json == "-" else console(sys.stdout, quiet)
    writable(json, plan.outputs, read)
    for files in plan.simulated_files():
        writable(None, files, read)
    keeper = open_keeper(plan, json, resume)
    saved = False
    try:
        with drawer_of(plan) as drawer:
            document, complete, solutions, rows = compute(plan, orbits, errors, began, keeper, told)
            if drawer is not None and document["branches"]:
                drawer.begin(document)
            tell = None if quiet else lambda: report_on(document, report)
            written = write_all(outputs_of(plan, document, json, solutions, rows, drawer), report, tell)
        saved = ("save" if "save" in plan.outputs else "json") in written.kinds
    except KeyboardInterrupt:
        if keeper is not None:
            keeper.give_up()
        raise
    finally:
        if keeper is not None:
            keeper.close(saved)
    return written.code(DONE if complete else CUT_SHORT)


def open_keeper(plan: Plan, json: str | None, resume: bool) -> SqliteJournal | PartialJson | None:
    """Where a run that writes a store or JSON keeps its branches while it goes.

    InputError where --resume has no file, or where a file is in the way that contin did not write.
    """
    path = plan.outputs.get("save")
    model = plain(describe_model(plan.model, plan.parameters))
    if path is not None:
        make_folder(path)
        journal = SqliteJournal(path, fingerprint(*provenance(plan).values()), resume, model)
        for note in journal.notes:
            warnings.warn(note, DamageWarning, stacklevel=2)
        return journal
    if resume:
        raise InputError("--resume needs the file that the run was saved to: give `outputs: {save: NAME.contin}`")
    target = plan.outputs.get("json") or (None if json in (None, "-") else Path(str(json)))
    if target is None or is_special(target):
        return None
    make_folder(target)
    return PartialJson(target, model)


def compute(
    plan: Plan,
    orbits: bool,
    errors: Console,
    began: float,
    keeper: SqliteJournal | PartialJson | None = None,
    told: bool = False,
) -> tuple[Fields, bool, Solutions | None, dict[str, Fields]]:
    """The result document, whether every requested branch is whole, and what stores and pages keep beside it."""
    status, stood = Status(errors), CLOCK.stood
    engine = ContinEngine(status.watch, Told(keeper, status.done) if told else keeper)
    imported("contin.api.branches")
    engine.load()
    at_hand = time.perf_counter()
    engine.prepare(plan.model)
    lowered = time.perf_counter()
    with telling(status.making), status:
        result = execute(plan, engine, status.say)
        simulates = bool(plan.simulations) or plan.sweep is not None
        simulated = (
            lazy.module("simulations").carry_out(plan, status.say, status.count, stopped=result.stopped)
            if simulates
            else Simulated({}, complete=True, notes=())
        )
    hold()
    ended = time.perf_counter()
    notes = [*result.notes, *simulated.notes]
    if keeper is not None:
        keeper.rest()
        notes += [*getattr(keeper, "notes", ()), *([keeper.trouble] if keeper.trouble else [])]
    timing = {
        "import": at_hand - began,
        "lower": lowered - at_hand,
        "kernels": CLOCK.stood - stood,
        "total": ended - began,
    }
    samples = OrbitSamples(notes.append) if orbits or "save" in plan.outputs else None
    document = result_document(
        {**describe_model(plan.model, plan.parameters), **({"title": plan.title} if plan.title else {})},
        result.branches.values(),
        timing=timing,
        notes=notes,
        orbit=samples,
        phase=result.phase,
        simulated=simulated.found,
        diagram=result.diagram,
        rows=kept_rows if samples is not None else None,
    )
    solutions = solutions_of(result.branches.values()) if "save" in plan.outputs else None
    page = any(path.suffix in PAGES for path in plan.outputs.values())
    rows = rows_of(result.branches.values()) if page else {}
    return document, result.complete and simulated.complete, solutions, rows


class Status:
    """What is being computed, on standard error: a moving line on a terminal, else a line every few seconds."""

    def __init__(self, console: Console) -> None:
        self.console = console
        moving = console.is_terminal and not console.quiet
        self.shown: Any = console.status("", spinner="dots") if moving else Ticker(console)
        self.run, self.began = "", time.perf_counter()

    def making(self, progress: Progress) -> None:
        """Where machine code is made, on its first use on a machine: the one line that explains the wait."""
        if progress.done == 0:
            self.console.print(f"Compiling {progress.total} numerical kernels for this machine, once ...")
        self._update(f"{self.run}: {progress.done} of {progress.total} kernels compiled")

    def say(self, what: str) -> None:
        """The name of the run that begins."""
        self.run = what
        self._update(what)

    def count(self, done: int, total: int) -> None:
        """After every run of a sweep; raises KeyboardInterrupt after Ctrl-C."""
        check()
        self._update(f"{self.run}: {done} of {total} runs")

    def watch(self, progress: Record) -> None:
        """After every chunk of a branch; raises KeyboardInterrupt after Ctrl-C."""
        check()
        told = [f"{progress['rows']} points"]  # no labels: the whole branch decides which of them are kept
        value, part = progress["value"], progress["fraction"]  # not numbers where a segment has no rows, a range no end
        if math.isfinite(value):
            of_range = f" ({part:.0%} of its range)" if math.isfinite(part) else ""
            told.insert(0, f"{progress['parameter']} = {value:.6g}{of_range}")
        self._update(f"{self.run}: {', '.join(told)}")

    def done(self, branch: Branch) -> None:
        """The line of a branch that is finished."""
        labels = ", ".join(point.label for point in branch.points) or "no special points"
        self.console.print(f"{branch.name}: {len(branch)} points; {labels}", style="dim")

    def _update(self, text: str) -> None:
        from rich.text import Text

        line = Text(text)
        if self.console.is_terminal:  # one line, beside the spinner: a line that wraps leaves its rest behind
            line = Text(f"{duration(time.perf_counter() - self.began)}  {text}")
            line.truncate(max(self.console.width - 4, 1), overflow="ellipsis")
        self.shown.update(line)

    def __enter__(self) -> None:
        self.shown.start()

    def __exit__(self, *_: object) -> None:
        self.shown.stop()
