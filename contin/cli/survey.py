"""`contin survey`: which parameters matter."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from contin.api.surveys import Survey, said, survey
from contin.cli.counting import counted
from contin.cli.interrupt import check
from contin.cli.look_options import as_look
from contin.cli.outputs import CUT_SHORT, DONE, writable, write_all
from contin.cli.run import parse_sets
from contin.cli.simulate import PICTURES, table_outputs, write_figure
from contin.cli.terminal import console
from contin.errors import InputError
from contin.model.registry import load
from contin.plot.survey import figure
from contin.records import Fields

if TYPE_CHECKING:
    from rich.console import Console


def survey_model(
    reference: str, names: Sequence[str], starts: Sequence[str], sets: Sequence[str], factor: float, most: int,
    processes: int | None, out: Fields, quiet: bool, began: float,
) -> int:  # fmt: skip
    """Survey, report, write files; exit code 1 where an arm could not be followed to an end that the system gives."""
    picture: Path | None = out["plot"]
    if picture is not None and picture.suffix not in PICTURES:
        raise InputError(f"--plot {picture}: pictures end in {', '.join(PICTURES)}")
    look = as_look(out["look"], None, None)
    writable(out["json"], {}, [])
    model = load(reference)
    report = console(sys.stderr if out["json"] == "-" else sys.stdout, quiet)
    with counted(f"survey of {model.name}", console(sys.stderr, quiet)) as count:

        def watch(done: int, total: int) -> None:
            check()
            count(done, total)

        found = survey(
            model, parse_sets(sets), names=names, starts=starts, factor=factor, most=most, processes=processes,
            watch=watch,
        )  # fmt: skip

    def tell() -> None:
        print_survey(found, report)
        report.print(f"{time.perf_counter() - began:.2f} s in all", style="dim", highlight=False)

    def draw(path: Path) -> str:
        write_figure(figure(found.document(), look=look), path)
        return str(path)

    document = found.document()
    drawing = None if picture is None else partial(draw, picture)
    outputs = table_outputs(found.columns, out["csv"], drawing, document, out["json"])
    whole = bool(found.rows) and all(side.complete for row in found.rows for side in (row.below, row.above))
    return write_all(outputs, report, tell).code(DONE if whole else CUT_SHORT)


def print_survey(found: Survey, report: Console) -> None:
    """A table for each attractor, then notes."""
    report.print(Text(f"{found.model}: {len(found.rows)} parameters and attractors, {found.seconds:.1f} s"))
    for name, one in found.attractors.items():
        report.print()
        report.print(Text.assemble((name, "bold cyan"), f"  {one}"))
        table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
        for heading in ("  parameter", "value", "below", "above"):
            table.add_column(heading, justify="right" if heading == "value" else "left")
        for row in found.rows:
            if row.attractor == name:
                ends = Text(said(row.below)), Text(said(row.above))
                table.add_row(Text(f"  {row.parameter}"), f"{row.value:.6g}", *ends)
        report.print(table)
    if found.notes:
        report.print()
        report.print("Notes", style="bold")
        for note in found.notes:
            report.print(Text(f"  {note}"))
