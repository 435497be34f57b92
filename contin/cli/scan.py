"""`contin scan`: many simulations over a grid, each named by what it settles on."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from contin._version import __version__
from contin.cli.counting import counted
from contin.cli.outputs import writable
from contin.cli.run import CUT_SHORT, DONE, parse_sets
from contin.cli.simulate import write_figure, write_json, write_table
from contin.cli.terminal import console
from contin.errors import InputError


def scan_file(
    file: Path, json: str | None, sets: Sequence[str], threads: int | None, cluster: str | None, resume: bool,
    quiet: bool,
) -> int:  # fmt: skip
    """Carry out a scan file; exit code 1 where a run did not settle."""
    from contin.runs.scan_plan import plan_scan
    from contin.simulate.scan import Outcome, scan

    plan = plan_scan(file, parse_sets(sets))
    writable(json, plan.outputs)
    if threads is not None and threads < 1:
        raise InputError(f"--threads must be 1 or more; got {threads}")
    report = console(sys.stderr if json == "-" else sys.stdout, quiet)
    store: Any = None
    known: dict[int, Outcome] = {}
    if "scan" in plan.outputs:
        from contin.store.scan_store import ScanStore

        store = ScanStore(plan.outputs["scan"], _mark(plan, file, sets), resume)
        known = {job: Outcome(*row) for job, row in store.rows.items()}
        if known:
            report.print(f"resumed: {len(known)} of {len(plan.spec)} runs were done")
    elif resume:
        raise InputError("--resume needs `outputs: {save: NAME.scan}` in the scan file")

    def record(job: int, outcome: Outcome) -> None:
        if store is not None:
            store.add(job, outcome.label, outcome.outcome, outcome.time, outcome.statistics)

    try:
        with counted(file.stem, console(sys.stderr, quiet)) as watch:
            rows = scan(plan.spec, threads=threads, cluster=cluster, known=known, record=record, watch=watch)
    finally:
        if store is not None:
            store.close()
    columns = plan.spec.columns(rows)
    counts = Counter(columns["class"])
    report.print(f"{len(rows)} runs")
    for label, count in counts.most_common():
        report.print(f"  {label}: {count}")
    unsettled = sum(outcome == "unsettled" for outcome in columns["outcome"])
    if unsettled:
        report.print(f"{unsettled} runs did not settle within `longest`; their class is that of the last window")
    _write(plan, columns, json, report)
    return CUT_SHORT if unsettled else DONE


def _write(plan: Any, columns: dict[str, Any], json: str | None, report: Any) -> None:
    axes = [name for name, _ in plan.spec.axes]
    if "csv" in plan.outputs:
        write_table(columns, plan.outputs["csv"])
    if "plot" in plan.outputs:
        from contin.plot.scan import figure

        write_figure(figure(columns, axes, title=plan.title), plan.outputs["plot"])
    document = {"contin": 1, "model": plan.spec.model.name, "axes": axes, "columns": columns}
    if "json" in plan.outputs:
        write_json(document, str(plan.outputs["json"]))
    for kind in ("csv", "plot", "json", "scan"):
        if kind in plan.outputs:
            report.print(f"wrote {plan.outputs[kind].name}")
    if json is not None:
        write_json(document, json)


def _mark(plan: Any, file: Path, sets: Sequence[str]) -> str:
    """Of all that determines the scan."""
    from contin.store.journal import fingerprint

    return fingerprint(__version__, plan.spec.model.text(), file.read_text(encoding="utf-8"), *sets)
