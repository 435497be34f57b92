"""`contin run` and `contin diagram`: plan, compute, report, write."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contin.cli.interrupt import check, hold
from contin.cli.outputs import provenance, tell_and_write, writable
from contin.cli.terminal import console
from contin.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from contin.runs.plan import Plan
    from contin.store.journal import SqliteJournal

DONE, CUT_SHORT = 0, 1


def run_file(
    file: Path, json: str | None, sets: Sequence[str], orbits: bool, quiet: bool, began: float, resume: bool = False
) -> int:
    """Carry out a run file, or a bundled one by its name; the exit code."""
    from contin.runs.bundled import find_run, is_scan
    from contin.runs.load import load_run_file
    from contin.runs.plan import make_plan

    file, place = find_run(file)
    if is_scan(file):
        from contin.cli.scan import scan_file

        return scan_file(file, json, sets, None, None, resume, None, quiet, place)
    overrides = parse_sets(sets)
    entry, source = load_run_file(file)
    return carry_out(make_plan(entry, source, place, overrides), json, orbits, quiet, began, resume)


def run_diagram(
    model: str,
    parameter: str,
    low: float,
    high: float,
    starts: Sequence[str],
    sets: Sequence[str],
    json: str | None,
    plot: Path | None,
    orbits: bool,
    quiet: bool,
    began: float,
) -> int:
    """Explore a diagram from the command line: the same as a run file with `diagram:`."""
    from dataclasses import replace

    from contin.model.source import CallSource
    from contin.runs.load import read_run
    from contin.runs.plan import make_plan

    diagram = {"parameter": parameter, "range": [low, high], **({"start": list(starts)} if starts else {})}
    source = CallSource("contin diagram")
    entry = read_run({"model": model, "diagram": diagram}, source, version_required=False)
    plan = make_plan(entry, source, Path.cwd() / "command line", parse_sets(sets))
    if plot is not None:
        plan = replace(plan, outputs={"plot": plot})
    return carry_out(plan, json, orbits, quiet, began)


def run_phase(
    model: str,
    parameters: tuple[str, str],
    ranges: tuple[tuple[float, float], tuple[float, float]],
    starts: Sequence[str],
    sets: Sequence[str],
    json: str | None,
    plot: Path | None,
    orbits: bool,
    quiet: bool,
    began: float,
) -> int:
    """A phase diagram from the command line: the same as a run file with `phase:`."""
    from dataclasses import replace

    from contin.model.source import CallSource
    from contin.runs.load import read_run
    from contin.runs.plan import make_plan

    bounds = {name: list(pair) for name, pair in zip(parameters, ranges, strict=True)}
    chosen = {"start": list(starts)} if starts else {}
    phase = {"parameter": list(parameters), "range": bounds, "orbits": orbits, **chosen}
    source = CallSource("contin phase")
    entry = read_run({"model": model, "phase": phase}, source, version_required=False)
    plan = make_plan(entry, source, Path.cwd() / "command line", parse_sets(sets))
    if plot is not None:
        plan = replace(plan, outputs={"plot": plot})
    return carry_out(plan, json, False, quiet, began)


def parse_sets(sets: Sequence[str]) -> dict[str, Any]:
    """--set NAME=VALUE, as overrides; a value may be a formula in the parameters."""
    overrides: dict[str, Any] = {}
    for text in sets:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"--set {text}: write --set NAME=VALUE, such as --set beta=0.8")
        try:
            overrides[name] = float(value)
        except ValueError:
            overrides[name] = value
    return overrides


def carry_out(plan: Plan, json: str | None, orbits: bool, quiet: bool, began: float, resume: bool = False) -> int:
    """Compute the plan, report it, and write its outputs; the exit code."""
    to_stdout = json == "-"
    errors = console(sys.stderr, quiet)
    report = errors if to_stdout else console(sys.stdout, quiet)
    writable(json, plan.outputs)
    for files in plan.simulated_files():
        writable(None, files)
    journal = open_journal(plan, resume)
    document, complete = compute(plan, orbits, errors, began, journal)
    tell_and_write(plan, document, json, report, quiet)
    return DONE if complete else CUT_SHORT


def open_journal(plan: Plan, resume: bool) -> SqliteJournal | None:
    """Where a run that saves its results keeps them while it goes; raises InputError where --resume has no file."""
    path = plan.outputs.get("save")
    if path is None:
        if resume:
            raise InputError("--resume needs the file that the run was saved to: give `outputs: {save: NAME.contin}`")
        return None
    from contin.runs.outputs import make_folder
    from contin.store.journal import SqliteJournal, fingerprint

    make_folder(path)
    return SqliteJournal(path, fingerprint(*provenance(plan).values()), resume)


def compute(
    plan: Plan, orbits: bool, errors: Console, began: float, journal: SqliteJournal | None = None
) -> tuple[dict[str, Any], bool]:
    """The result document, and whether every requested branch is whole."""
    from contin.kernels.clock import CLOCK
    from contin.kernels.compile import telling
    from contin.runs.engine import ContinEngine
    from contin.runs.execute import execute
    from contin.runs.results import sample_orbit
    from contin.runs.simulations import carry_out as carry_out_simulations
    from contin.runs.warm import warm_up
    from contin.store.json_format import describe_model, result_document

    status = Status(errors)
    engine = ContinEngine(status.watch, journal)
    engine.load()
    imported = time.perf_counter()
    engine.prepare(plan.model)
    lowered = time.perf_counter()
    with telling(status.compiling):
        warm_up()
        warm, stood = time.perf_counter(), CLOCK.stood
        with status:
            result = execute(plan, engine, status.say)
            simulated, whole = ({}, False) if result.stopped else carry_out_simulations(plan, status.say, status.count)
    hold()
    ended = time.perf_counter()
    notes = [*result.notes]
    if journal is not None:
        journal.close()
        notes += [journal.trouble] if journal.trouble else []
    timing = {
        "import": imported - began,
        "lower": lowered - imported,
        "kernels": warm - lowered + CLOCK.stood - stood,  # those that the runs loaded too
        "total": ended - began,
    }
    document = result_document(
        {**describe_model(plan.model, plan.parameters), **({"title": plan.title} if plan.title else {})},
        result.branches.values(),
        timing=timing,
        notes=notes,
        orbit=sample_orbit if orbits or "save" in plan.outputs else None,
        phase=result.phase,
        simulated=simulated,
    )
    return document, result.complete and whole


class Status:
    """What is being computed, on standard error, while it is a terminal."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.shown = console.status("", spinner="dots") if console.is_terminal and not console.quiet else None
        self.run = ""
        self.told: set[str] = set()  # of kernels that are compiled

    def compiling(self, module: str) -> None:
        """Where kernels are compiled, on their first use on a machine: the one line that explains the wait."""
        from contin.runs.warm import waiting

        text = waiting(module)
        if text is not None and text not in self.told:
            self.told.add(text)
            self.console.print(text)

    def say(self, what: str) -> None:
        """The name of the run that begins."""
        self.run = what
        self._update(what)

    def count(self, done: int, total: int) -> None:
        """After every run of a sweep; raises KeyboardInterrupt after Ctrl-C."""
        check()
        self._update(f"{self.run}: {done} of {total} runs")

    def watch(self, progress: Mapping[str, Any]) -> None:
        """After every chunk of a branch; raises KeyboardInterrupt after Ctrl-C."""
        check()
        labels = ", ".join(progress["labels"]) or "none"
        position = f"{progress['parameter']} = {progress['value']:.6g} ({progress['fraction']:.0%} of its range)"
        self._update(f"{self.run}: {position}, {progress['rows']} points, labels: {labels}")

    def _update(self, text: str) -> None:
        if self.shown is not None:
            from rich.text import Text

            self.shown.update(Text(text))

    def __enter__(self) -> None:
        if self.shown is not None:
            self.shown.start()

    def __exit__(self, *_: object) -> None:
        if self.shown is not None:
            self.shown.stop()
