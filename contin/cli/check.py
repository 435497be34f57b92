"""`contin check`: what is wrong with a run file, a model file or a result file, without computing anything."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contin.cli.outputs import writable
from contin.cli.printable import printable
from contin.cli.terminal import console
from contin.cli.ticker import Ticker
from contin.errors import InputError
from contin.model.bundled import model_file, runs
from contin.model.registry import find
from contin.model.yaml_loader import model_from_document
from contin.model.yaml_reader import read_file
from contin.runs.bundled import find_run, is_scan
from contin.runs.expect import verify_expectations
from contin.runs.foreign import is_foreign
from contin.runs.load import read_run
from contin.runs.outputs import files_read
from contin.runs.plan import make_plan
from contin.runs.scan_plan import plan_scan
from contin.runs.simulation_plan import described
from contin.store.verify import is_result, verify
from contin.symbolic.passes.conserved import conserved_notes, without_conserved
from contin.symbolic.passes.index_one import index_one

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.model.yaml_reader import Document

MODEL_KEYS: Final = frozenset({"states", "equations"})  # a run file has neither
LONG: Final = 500_000  # bytes of a file that takes more than a second to read


def check_file(file: Path, execute: bool) -> int:
    """Check one file; with `execute`, carry out a model's `expect:` too. The exit code."""
    if is_result(file):
        print(f"{file}: good. {verify(file)}; every part is as it was written")
        return 0
    if is_foreign(file):
        return check_foreign(file)
    named = None if file.exists() else model_file(file.as_posix())  # a bundled model, as other commands take it
    file, place = (named, named) if named is not None and file.as_posix() not in runs() else find_run(file)
    with reading(file) as tell:
        document = read_file(file)
        tell("its formulas")
        return check_document(file, place, document, execute)


@contextmanager
def reading(file: Path) -> Iterator[Callable[[str], None]]:
    """What is being read of a long file: a line on a terminal, a line every few seconds elsewhere.

    The caller names the next part.
    """
    if not (file.is_file() and file.stat().st_size > LONG):
        yield lambda what: None
        return

    shown, text = console(sys.stderr, False), f"reading {printable(file.name)}"
    if shown.is_terminal:
        with shown.status(text) as status:
            yield lambda what: status.update(f"{text}: {what}")
        return
    ticker = Ticker(shown)
    ticker.update(text)
    ticker.start()
    try:
        yield lambda what: ticker.update(f"{text}: {what}")
    finally:
        ticker.stop()


def check_document(file: Path, place: Path, document: Document, execute: bool) -> int:
    """Check what was read from a file; `place` is where its outputs go."""
    if isinstance(document.data, dict) and MODEL_KEYS & document.data.keys() and "model" not in document.data:
        return check_model(file, document, execute)
    if execute:
        raise InputError(
            f"{file}: --run carries out the `expect:` of a model file; this is a run file (use `contin run`)"
        )

    if is_scan(file):
        spec = plan_scan(file, counts_as=place).spec
        print(f"{file}: good. Model {spec.model.name}, {len(spec.model.states)} states; a scan of {len(spec)} runs")
        return 0
    entry = read_run(document.data, document.source)
    plan = make_plan(entry, document.source, place)
    index_one(plan.model)
    for files in (plan.outputs, *plan.simulated_files()):
        writable(None, files, files_read(entry, file))
    runs = [run.name for run in plan.runs]
    phases = [f"phase diagram in {' and '.join(plan.phase.parameters)}"] if plan.phase else []
    what = ", ".join(
        ([f"diagram in {plan.diagram.parameter}"] if plan.diagram else [])
        + phases
        + runs
        + described(plan.simulations, plan.sweep)
    )
    print(f"{file}: good. Model {plan.model.name}, {len(plan.model.states)} states; runs: {what}")
    for line in conserved_notes(plan.model):
        print(f"  {line}")
    return 0


def check_foreign(file: Path) -> int:
    """Check a model in the format of another program."""
    model = find(file)
    print(f"{file}: good. Model {model.name}: {len(model.states)} states, {len(model.parameters)} parameters")
    _tell_conserved(model)
    return 0


def _tell_conserved(model: Model) -> None:
    for line in conserved_notes(without_conserved(model)):
        print(f"  {line}")


def check_model(file: Path, document: Document, execute: bool) -> int:
    """Check a model file, and with `execute` that its expected points are found."""
    model = model_from_document(document)
    fields = getattr(model, "fields", ())
    if not fields:
        index_one(model)
    size = f"{len(fields)} fields, {model.n} unknowns" if fields else f"{len(model.states)} states"  # type: ignore[attr-defined]
    counts = f"{size}, {len(model.parameters)} parameters, {len(model.starts)} named starts"
    print(f"{file}: good. Model {model.name}: {counts}")
    _tell_conserved(model)
    if not execute:
        return 0

    failed = 0
    for report in verify_expectations(model):
        failed += not report.holds
        print(f"  {'holds' if report.holds else 'FAILS'}: {report.text}")
    return 1 if failed else 0
