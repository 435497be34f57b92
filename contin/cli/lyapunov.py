"""`contin lyapunov`: Lyapunov exponents of a trajectory, or along a parameter."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contin.cli.counting import counted
from contin.cli.look_options import as_look
from contin.cli.outputs import CUT_SHORT, DONE, writable, write_all
from contin.cli.run import parse_sets
from contin.cli.simulate import PICTURES, starting_point, table_outputs, write_figure
from contin.cli.terminal import console
from contin.errors import InputError
from contin.exponents.lyapunov import lyapunov
from contin.limits import LARGEST_TABLE, check_count
from contin.model.registry import load
from contin.plot.exponents import figure
from contin.records import Fields, Record

Along = tuple[str | None, float | None, float | None, int]


def exponents_of_model(
    reference: str, along: Along, start: str | None, states: Sequence[str], sets: Sequence[str], options: Record,
    out: Fields, quiet: bool,
) -> int:  # fmt: skip
    """Compute, report, write files; exit code 1 where a trajectory ended early."""
    parameter, low, high, points = along
    picture, table = out["plot"], out["csv"]
    if picture is not None and picture.suffix not in PICTURES:
        raise InputError(f"--plot {picture}: pictures end in {', '.join(PICTURES)}")
    if parameter is None and picture is not None:
        raise InputError("--plot draws exponents over a parameter: contin lyapunov MODEL PARAMETER LO HI --plot ...")
    stepped: Fields = {}
    if parameter is not None:
        if low is None or high is None or not (np.isfinite(low) and np.isfinite(high) and low != high):
            raise InputError(f"{parameter}: two different numbers are needed after it, as in {parameter} 0 1")
        check_count("--points", points, 2, LARGEST_TABLE)
        stepped = {"parameter": parameter, "values": np.linspace(low, high, points).tolist()}
    look = as_look(out["look"], None, None)
    writable(out["json"], {})
    model = load(reference)
    report = console(sys.stderr if out["json"] == "-" else sys.stdout, quiet)
    with counted(f"exponents of {model.name}", console(sys.stderr, quiet)) as watch:
        found = lyapunov(
            model, starting_point(model, start, states), parse_sets(sets), watch=watch, **stepped, **options
        )
    done = all(outcome == "done" for outcome in found.outcomes)

    def tell() -> None:
        report.print(f"{found}", style="" if done else "yellow")
        if not found.parameter and done:
            dimension = f"Kaplan-Yorke dimension {found.dimension:.6g}"
            report.print(f"signs {found.signs[0]}, {dimension}, over a time of {found.times[0]:.6g}")
        for text in found.notes:
            report.print(text, style="yellow")

    def draw() -> str:
        write_figure(figure(found, look=replace(look, title=look.title or model.title)), picture)
        return str(picture)

    document = {
        "contin": 1, "model": model.name, "lyapunov": found.parameter, "complete": found.complete,
        "notes": list(found.notes), "columns": found.columns,
    }  # fmt: skip
    outputs = table_outputs(found.columns, table, draw if picture is not None else None, document, out["json"])
    return write_all(outputs, report, tell).code(DONE if done else CUT_SHORT)
