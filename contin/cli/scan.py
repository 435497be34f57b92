"""`contin scan`: many simulations over a grid, each named by what it settles on."""

from __future__ import annotations

import sys
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contin._version import __version__
from contin.cli.counting import counted
from contin.cli.interrupt import check, hold
from contin.cli.outputs import CUT_SHORT, DONE, Output, writable, write_all
from contin.cli.run import parse_sets
from contin.cli.simulate import PICTURES, write_figure, write_json, write_table
from contin.cli.terminal import console
from contin.errors import InputError
from contin.plot.look import Look
from contin.plot.scan import figure
from contin.records import Fields, Record
from contin.runs.outputs import make_folder
from contin.runs.scan_plan import plan_scan
from contin.simulate.scan.carry_out import carry_out, document_of
from contin.store.digest import DamageWarning
from contin.store.journal import fingerprint
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import read_results
from contin.store.run_files import checked
from contin.store.scan_store import ScanStore, read_scan

if TYPE_CHECKING:
    from rich.console import Console

    from contin.runs.scan_plan import ScanPlan
    from contin.simulate.scan.grid import Outcome
    from contin.store.scan_store import ScanStore


def scan_file(
    file: Path, json: str | None, sets: Sequence[str], threads: int | None, cluster: str | None, resume: bool,
    over: Path | None, quiet: bool, place: Path | None = None,
) -> int:  # fmt: skip
    """Carry out a scan file. A run that escapes or does not settle is a result like others: exit code 0.

    A scan that is stopped writes what was computed (exit code 1); with a store it goes on with --resume.
    """
    plan = plan_scan(file, parse_sets(sets), place)
    writable(json, plan.outputs, [*plan.reads, *([over] if over is not None else [])])
    if threads is not None and threads < 1:
        raise InputError(f"--threads must be 1 or more; got {threads}")
    if over is not None and "plot" not in plan.outputs:
        raise InputError("--over needs `outputs: {plot: NAME.png}` in the scan file")
    beneath = _results(over)
    report = console(sys.stderr if json == "-" else sys.stdout, quiet)
    store = _store(plan, file, sets, resume)
    rows = dict(store.rows) if store is not None else {}
    if rows:
        report.print(f"resumed: {len(rows)} of {len(plan.spec)} runs were done")

    def keep(job: int, outcome: Outcome) -> None:
        rows[job] = outcome
        if store is not None:
            store.add(job, outcome)

    stopped = ""
    try:
        with counted(file.stem, console(sys.stderr, quiet)) as watch:
            carry_out(
                plan.spec, threads=threads, cluster=cluster, known=store.rows if store else None, record=keep,
                watch=_checked(watch),
            )  # fmt: skip
    except KeyboardInterrupt:
        stopped = f"stopped by the user: {len(rows)} of {len(plan.spec)} runs were done"
    finally:
        hold()
        if store is not None:
            store.close(complete=len(rows) == len(plan.spec))
    document = document_of(plan.spec, rows)
    document["model"]["title"] = plan.title
    notes = [*(store.notes if store is not None else []), *([stopped] if stopped else [])]
    if notes:
        document["notes"] = notes
    written = write_all(_outputs(plan, document, beneath, json), report, lambda: _tell(document, report))
    if store is not None and store.trouble:
        written.add(store.trouble)
    return written.code(CUT_SHORT if stopped else DONE)


def _checked(watch: Callable[[int, int], None]) -> Callable[[int, int], None]:
    """`watch` that also raises KeyboardInterrupt if the program was asked to stop."""

    def watching(done: int, total: int) -> None:
        watch(done, total)
        check()

    return watching


def _store(plan: ScanPlan, file: Path, sets: Sequence[str], resume: bool) -> ScanStore | None:
    path = plan.outputs.get("save")
    if path is None:
        if resume:
            raise InputError("--resume needs `outputs: {save: NAME.scan}` in the scan file")
        return None
    make_folder(path)
    empty = document_of(plan.spec, {})
    empty["model"]["title"] = plan.title
    store = ScanStore(path, _mark(plan, file, sets), empty, resume)
    for note in store.notes:
        warnings.warn(note, DamageWarning, stacklevel=2)
    return store


def plot_scan(file: Path, out: Path, look: Look, over: Path | None) -> int:
    """Draw a saved scan, also one that is not finished."""
    if out.suffix not in PICTURES:
        raise InputError(f"{out}: pictures end in {', '.join(PICTURES)}")
    write_figure(figure(_stored(file), look=look, over=_results(over)), out)
    print(out)
    return DONE


def _stored(file: Path) -> Fields:
    """A scan from its store or from JSON."""
    return read_scan(file) if ending_of(file) == ".scan" else checked(read_mapping(file), "scan", file)


def export_scan(file: Path, out: Path) -> int:
    """Write a saved scan as a table (.csv) or as JSON."""
    document = _stored(file)
    if out.suffix == ".csv":
        write_table(document["columns"], out)
    elif out.suffix == ".json":
        write_json(document, str(out))
    else:
        raise InputError(f"{out}: a scan is exported as .csv or .json")
    print(out)
    return DONE


def _results(path: Path | None) -> Fields | None:
    if path is None:
        return None

    return read_results(path)


def _tell(document: Record, report: Console) -> None:
    columns = document["columns"]
    report.print(f"{len(columns['class'])} runs")
    for label, count in Counter(columns["class"]).most_common():
        report.print(f"  {label}: {count}")
    unsettled = sum(outcome == "unsettled" for outcome in columns["outcome"])
    if unsettled:
        report.print(f"{unsettled} runs did not settle within `longest`; their class is that of the last window")


def _outputs(plan: ScanPlan, document: Fields, beneath: Record | None, json: str | None) -> list[Output]:
    """Every file that the scan file and the command line ask for; the store is there already."""
    files = [Output(kind, partial(_write, plan, kind, document, beneath)) for kind in plan.outputs]
    return [*files, *([Output("json", partial(write_json, document, json))] if json is not None else [])]


def _write(plan: ScanPlan, kind: str, document: Fields, beneath: Record | None) -> str | None:
    path = plan.outputs[kind]
    make_folder(path)
    if kind == "csv":
        write_table(document["columns"], path)
    elif kind == "plot":
        if not document["columns"]["class"]:
            return f"{path.name} is not drawn: no run is done"
        write_figure(figure(document, look=Look.of(plan.look), over=beneath), path)
    elif kind == "json":
        write_json(document, str(path))
    return f"wrote {path.name}"


def _mark(plan: Any, file: Path, sets: Sequence[str]) -> str:
    """Of all that determines the runs; where files are written does not."""
    spec = plan.spec
    return fingerprint(
        __version__, spec.model.text(), repr(spec.head()), repr(spec.starts), repr(sorted(spec.parameters.items())),
        repr(sorted(spec.measures.items())), *sets,
    )  # fmt: skip
