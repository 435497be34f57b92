"""`contin orbit`: the orbit at a labelled point of saved results, in numbers."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from rich.table import Table
from rich.text import Text

from contin.api.reading import Results, read
from contin.cli.multipliers import multiplier_words
from contin.cli.outputs import writable
from contin.cli.terminal import console
from contin.continuation.branch import SpecialPoint
from contin.errors import InputError
from contin.model.advice import closest
from contin.store.atomic import write_text


def show_orbit(file: Path, place: str, csv: str | None) -> int:
    """Tell period, multipliers and extremes of the orbit at BRANCH.LABEL; its samples go to the file `csv`, or `-`."""
    point = point_at(read(file), place)
    orbit = point.orbit
    if csv == "-":
        sys.stdout.write(orbit.csv())
        return 0
    if csv is not None:
        writable(None, {"csv": Path(csv)}, [file])
        write_text(Path(csv), orbit.csv())
    report = console(sys.stdout, False)
    where = ", ".join(f"{name} = {point.values[name]:.10g}" for name in point.problem.parameters)
    report.print(Text(f"{place}: {where}; period {orbit.period:.10g}; {len(orbit.t)} times"))
    report.print(Text("multipliers  " + multiplier_words(orbit.multipliers)))
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for title in ("", "least", "largest"):
        table.add_column(title, justify="right" if title else "left", no_wrap=True)
    for name, column in orbit.columns.items():
        if name != "t":
            low = point.values.get(f"{name}.min", np.min(column))  # between the samples, too
            table.add_row(name, f"{low:.10g}", f"{point.values.get(f'{name}.max', np.max(column)):.10g}")
    report.print(table)
    if csv is not None:
        report.print(Text(f"wrote {csv}"))
    return 0


def point_at(results: Results, place: str) -> SpecialPoint:
    """The point BRANCH.LABEL; InputError where there is none."""
    name, dot, label = place.rpartition(".")
    if not dot:
        raise InputError(f"{place}: expected BRANCH.LABEL, such as cycles.LPC1")
    names = [branch.name for branch in results]
    if name not in names:
        raise InputError(f"there is no branch {name!r}: {closest(name, names) or 'branches: ' + ', '.join(names)}")
    for point in results[name].points:
        if point.label == label:
            return point
    labels = ", ".join(point.label for point in results[name].points) or "none"
    raise InputError(f"{name} has no point {label!r}; its points: {labels}")
