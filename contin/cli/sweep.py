"""`contin sweep`: a parameter up and down, the state carried along."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from contin.cli.counting import counted
from contin.cli.look_options import as_look
from contin.cli.outputs import CUT_SHORT, DONE, writable, write_all
from contin.cli.run import parse_sets
from contin.cli.simulate import PICTURES, starting_point, table_outputs, write_figure
from contin.cli.terminal import console
from contin.errors import InputError
from contin.model.registry import load
from contin.plot.sweep import figure
from contin.records import Fields
from contin.simulate.steady import Criterion
from contin.simulate.sweep import sweep
from contin.store.results import read_results


def sweep_model(
    reference: str, parameter: str, low: float, high: float, start: str | None, states: Sequence[str],
    sets: Sequence[str], measures: Sequence[str], steps: int, waiting: dict[str, float | None], out: Fields,
    over: Path | None, quiet: bool,
) -> int:  # fmt: skip
    """Sweep, report jumps, write files; exit code 1 where a run did not settle."""
    picture, table = out["plot"], out["csv"]
    if picture is not None and picture.suffix not in PICTURES:
        raise InputError(f"--plot {picture}: pictures end in {', '.join(PICTURES)}")
    look = as_look(out["look"], None, out["y"])
    writable(out["json"], {}, [over] if over is not None else [])
    model = load(reference)
    document = None
    if over is not None:
        document = read_results(over)
    given: Fields = {key: value for key, value in waiting.items() if value is not None}
    if given and "window" not in given:
        raise InputError("--longest and --tolerance belong to a --window: give that too")
    quantities = {name: str(formula) for name, formula in parse_sets(measures).items()}
    report = console(sys.stderr if out["json"] == "-" else sys.stdout, quiet)

    with counted(f"{parameter} from {low:g} to {high:g} and back", console(sys.stderr, quiet)) as watch:
        found = sweep(
            model, parameter, (low, high), start=starting_point(model, start, states), parameters=parse_sets(sets),
            steps=steps, measures=quantities or None, watch=watch,
            criterion=Criterion(**given) if given else None,
        )  # fmt: skip
    unsettled = sum(outcome != "settled" for outcome in found.outcomes)

    def tell() -> None:
        report.print(f"{len(found.values)} runs, {len(found.values) - unsettled} settled")
        for direction, before, after in found.jumps(found.names[0]):
            word = "up" if direction > 0 else "down"
            report.print(f"  {found.names[0]} jumps on the way {word} between {parameter} = {before:g} and {after:g}")

    def draw() -> str:
        named = replace(look, title=look.title or model.title)
        drawing = figure(found.columns, parameter, found.names, look=named, over=document)
        write_figure(drawing, picture)
        return str(picture)

    results = {"contin": 1, "model": model.name, "sweep": parameter, "columns": found.columns}
    outputs = table_outputs(found.columns, table, draw if picture is not None else None, results, out["json"])
    return write_all(outputs, report, tell).code(CUT_SHORT if unsettled else DONE)
