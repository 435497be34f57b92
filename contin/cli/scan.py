"""`contin scan`: many simulations over a grid, each named by what it settles on."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from contin._version import __version__
from contin.cli.counting import counted
from contin.cli.outputs import writable
from contin.cli.run import DONE, parse_sets
from contin.cli.simulate import write_figure, write_json, write_table
from contin.cli.terminal import console
from contin.errors import InputError


def scan_file(
    file: Path, json: str | None, sets: Sequence[str], threads: int | None, cluster: str | None, resume: bool,
    over: Path | None, quiet: bool, place: Path | None = None,
) -> int:  # fmt: skip
    """Carry out a scan file. A run that escapes or does not settle is a result like others: exit code 0."""
    from contin.runs.scan_plan import plan_scan
    from contin.simulate.scan.carry_out import carry_out, document_of

    plan = plan_scan(file, parse_sets(sets), place)
    writable(json, plan.outputs)
    if threads is not None and threads < 1:
        raise InputError(f"--threads must be 1 or more; got {threads}")
    if over is not None and "plot" not in plan.outputs:
        raise InputError("--over needs `outputs: {plot: NAME.png}` in the scan file")
    beneath = _results(over)
    report = console(sys.stderr if json == "-" else sys.stdout, quiet)
    store: Any = None
    if "save" in plan.outputs:
        from contin.runs.outputs import make_folder
        from contin.store.scan_store import ScanStore

        make_folder(plan.outputs["save"])
        empty = document_of(plan.spec, {})
        empty["model"]["title"] = plan.title
        store = ScanStore(plan.outputs["save"], _mark(plan, file, sets), empty, resume)
        if store.rows:
            report.print(f"resumed: {len(store.rows)} of {len(plan.spec)} runs were done")
    elif resume:
        raise InputError("--resume needs `outputs: {save: NAME.scan}` in the scan file")
    try:
        with counted(file.stem, console(sys.stderr, quiet)) as watch:
            rows = carry_out(
                plan.spec, threads=threads, cluster=cluster, known=store.rows if store else None,
                record=store.add if store else None, watch=watch,
            )  # fmt: skip
    finally:
        if store is not None:
            store.close()
    document = document_of(plan.spec, rows)
    document["model"]["title"] = plan.title
    _tell(document, report)
    _write(plan.outputs, document, beneath, report)
    if json is not None:
        write_json(document, json)
    return DONE


def plot_scan(file: Path, out: Path, x: str | None, y: str | None, over: Path | None) -> int:
    """Draw a saved scan, also one that is not finished."""
    from contin.cli.simulate import PICTURES
    from contin.plot.scan import figure
    from contin.store.scan_store import read_scan

    if out.suffix not in PICTURES:
        raise InputError(f"{out}: pictures end in {', '.join(PICTURES)}")
    write_figure(figure(read_scan(file), x=x, y=y, over=_results(over)), out)
    print(out)
    return DONE


def export_scan(file: Path, out: Path) -> int:
    """Write a saved scan as a table (.csv) or as JSON."""
    from contin.store.scan_store import read_scan

    document = read_scan(file)
    if out.suffix == ".csv":
        write_table(document["columns"], out)
    elif out.suffix == ".json":
        write_json(document, str(out))
    else:
        raise InputError(f"{out}: a scan is exported as .csv or .json")
    print(out)
    return DONE


def _results(path: Path | None) -> dict[str, Any] | None:
    if path is None:
        return None
    from contin.store.results import read_results

    return read_results(path)


def _tell(document: Mapping[str, Any], report: Any) -> None:
    columns = document["columns"]
    report.print(f"{len(columns['class'])} runs")
    for label, count in Counter(columns["class"]).most_common():
        report.print(f"  {label}: {count}")
    unsettled = sum(outcome == "unsettled" for outcome in columns["outcome"])
    if unsettled:
        report.print(f"{unsettled} runs did not settle within `longest`; their class is that of the last window")


def _write(outputs: Mapping[str, Path], document: dict[str, Any], beneath: Any, report: Any) -> None:
    from contin.runs.outputs import make_folder

    for kind, path in outputs.items():
        make_folder(path)
        if kind == "csv":
            write_table(document["columns"], path)
        elif kind == "plot":
            from contin.plot.scan import figure

            write_figure(figure(document, over=beneath), path)
        elif kind == "json":
            write_json(document, str(path))
        report.print(f"wrote {path.name}")


def _mark(plan: Any, file: Path, sets: Sequence[str]) -> str:
    """Of all that determines the runs; where files are written does not."""
    from contin.store.journal import fingerprint

    spec = plan.spec
    return fingerprint(
        __version__, spec.model.text(), repr(spec.head()), repr(spec.starts), repr(sorted(spec.parameters.items())),
        repr(sorted(spec.measures.items())), *sets,
    )  # fmt: skip
