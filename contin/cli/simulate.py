"""`contin simulate`: a trajectory as a table, as CSV, as a picture."""

from __future__ import annotations

import csv
import io
import json as json_library
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from contin.cli.look_options import as_look
from contin.cli.outputs import CUT_SHORT, DONE, Output, json_to_stdout, writable, write_all
from contin.cli.run import parse_sets
from contin.cli.terminal import console
from contin.errors import InputError
from contin.model.registry import load
from contin.plot.trajectory import figure
from contin.records import Fields
from contin.simulate.run import simulate
from contin.store.atomic import write_bytes, write_text
from contin.store.digest import signed
from contin.store.json_format import plain, write_json_text

if TYPE_CHECKING:
    from rich.console import Console

    from contin.model.model import Model

ROWS: Final = 11  # of the table on the terminal
PICTURES: Final = (".png", ".pdf", ".svg")


def simulate_model(
    reference: str, start: str | None, states: Sequence[str], sets: Sequence[str], out: Fields, quiet: bool,
    **options: Any,
) -> int:  # fmt: skip
    """Simulate, print a table, write the files of `out` (csv, plot, json, x, y); exit code 1 where it ended early."""
    picture, table = out["plot"], out["csv"]
    if picture is not None and picture.suffix not in PICTURES:
        raise InputError(f"--plot {picture}: pictures end in {', '.join(PICTURES)}")
    look = as_look(out["look"], out["x"], None if out["y"] is None else [out["y"]])
    for path in (picture, table):
        if path is not None and not path.absolute().parent.is_dir():
            raise InputError(f"{path}: there is no folder {path.parent}")
    writable(out["json"], {})
    model = load(reference)
    if picture is not None and getattr(model, "observables", None) is not None:
        look.check_columns(["t", *model.state_names, *model.observables])
    found = simulate(model, starting_point(model, start, states), parse_sets(sets), **options)
    section = found.section  # which the tables and the portrait are of, where there is one
    columns = found.columns if section is None else section
    report = console(sys.stderr if out["json"] == "-" else sys.stdout, quiet)

    def tell() -> None:
        _print_table(columns, report)
        report.print(str(found), style="" if found.complete else "yellow")

    def draw() -> str:
        named = replace(look, title=look.title or model.title or model.name)
        drawing = figure(found.drawn, list(model.state_names), look=named, section=section)
        write_figure(drawing, picture)
        return str(picture)

    document = {
        "contin": 1, "model": model.name, "method": found.method, "outcome": found.outcome, "why": found.why,
        "end_time": found.end_time, "columns": found.columns,
    }  # fmt: skip
    if found.jumps:
        document["events"] = found.events
    if section is not None:
        document["section"] = section
    written = found.table if section is None else section
    outputs = table_outputs(written, table, draw if picture is not None else None, document, out["json"])
    return write_all(outputs, report, tell).code(DONE if found.complete else CUT_SHORT)


def table_outputs(
    columns: Fields, table: Path | None, draw: Callable[[], str] | None, document: Fields,
    json: str | None,
) -> list[Output]:  # fmt: skip
    """What `contin simulate` and `contin sweep` write: a table, a picture, JSON."""
    outputs = []
    if table is not None:
        outputs.append(Output("csv", partial(_write_table, columns, table)))
    if draw is not None:
        outputs.append(Output("plot", draw))
    if json is not None:
        outputs.append(Output("json", partial(write_json, document, json)))
    return outputs


def _write_table(columns: Fields, path: Path) -> str:
    write_table(columns, path)
    return str(path)


def starting_point(model: Model, start: str | None, states: Sequence[str]) -> Any:
    """--start NAME and --state NAME=VALUE as a start: the values replace those of the named one."""
    values = parse_sets(states)
    if not values:
        return start
    for name in values:
        if name not in model.state_names:
            raise InputError(f"--state {name}: {model.name} has no such state; it has {', '.join(model.state_names)}")
    if start is None:
        return values
    named = model.start(start)
    return {**named.states, **values, **({"parameters": dict(named.parameters)} if named.parameters else {})}


def write_table(columns: Fields, path: Path) -> None:
    """Columns of equal length as CSV, numbers with all their digits."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        writer.writerow([v if isinstance(v, str) else repr(v.item() if hasattr(v, "item") else v) for v in row])
    write_text(path, stream.getvalue())


def write_figure(drawing: Any, path: Path) -> None:
    """A matplotlib figure to a file whose ending chooses the kind."""
    stream = io.BytesIO()
    drawing.savefig(stream, format=path.suffix[1:])
    write_bytes(path, stream.getvalue())


def write_json(document: Fields, target: str) -> None:
    """A document with its `sha256` as JSON, to a file or to standard output for '-'; NaN and infinity as null."""
    text = json_library.dumps(signed(plain(document)), indent=1) + "\n"
    if target == "-":
        json_to_stdout(text)
    else:
        write_json_text(text, Path(target))


def _print_table(columns: Fields, report: Console) -> None:
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for name in columns:
        table.add_column(name, justify="right", no_wrap=True)
    count = len(columns["t"])
    chosen = sorted({round(k * (count - 1) / (ROWS - 1)) for k in range(ROWS)}) if count else []
    for row in chosen:
        table.add_row(*(f"{float(column[row]):.7g}" for column in columns.values()))
    report.print(table)
