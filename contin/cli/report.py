"""The human report of a result: special points, ends in words and effort, as tables on the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from contin import lazy
from contin.cli.multipliers import multiplier_words
from contin.diagram.phase.report import region_lines
from contin.plot.vocabulary import KINDS, locus_words, style_of
from contin.records import Record

MOST_MULTIPLIERS: Final = 6  # told of a point; the JSON has all of them
MOST_STATES: Final = 4  # columns of states in a table; the JSON has all of them
UNSEEN: Final = 1e-8  # of a column's largest value: an error that eight digits hardly show
EPSILON: Final = 2.0**-52
UNBOUNDED: Final = 10_000  # columns of a console in which no table is shortened
_COEFFICIENTS: Final = ("l1", "l2", "a", "b", "c", "d")  # the first that there is decides
_OF_KIND: Final = {"pitchfork": "b30", "transcritical": "b20"}


def _size(model: Record) -> str:
    """How large the model is, in words."""
    if "fields" in model:
        return f"{', '.join(model['fields'])} on {', '.join(model['axes'])}: {model['unknowns']} unknowns"
    return f"{len(model['states'])} states"


def print_report(document: Record, console: Console) -> None:
    """Print every branch of a result document, then notes and time."""
    model = document["model"]
    console.print(Text.assemble((model["name"], "bold"), f"  ({_size(model)})"))
    for branch in document["branches"]:
        console.print()
        _print_branch(branch, model["states"], console)
    if document.get("phase"):
        _print_regions(document["phase"], console)
    _print_simulated(document, console)
    _print_notes(document["notes"], console)
    console.print()
    console.print(_effort(document), style="dim", highlight=False)


def _print_branch(branch: Record, states: Iterable[str], console: Console) -> None:
    console.print(heading(branch), highlight=False)
    if branch["points"]:
        console.print(_fitting(branch, list(states), console))
    else:
        console.print("  no special points", highlight=False)
    _print_multipliers(branch, console)
    for which, end in zip(("first row", "last row"), branch["ends"], strict=True):
        if end["reason"] != "start":
            style = "yellow" if end["reason"] in ("corrector", "steps", "stopped") else ""
            console.print(Text(f"  {which}: {end['text']}", style=style))


def _print_multipliers(branch: Record, console: Console) -> None:
    """The multipliers at the labels of orbits and of maps, the largest in modulus first."""
    if branch["kind"] == "locus":
        return
    for point in branch["points"]:
        known = [complex(*pair) for pair in point.get("multipliers", []) if None not in pair]
        if known:
            words = multiplier_words(known, MOST_MULTIPLIERS)
            console.print(Text(f"  {point['label']:<5}  multipliers {words}", style="dim"))


def _print_regions(phase: Record, console: Console) -> None:
    if not phase["regions"]:  # stopped before the first one; the notes say so
        return
    console.print()
    console.print("Regions", style="bold")
    for line in region_lines(phase):
        console.print(Text(f"  {line}"))


def _print_simulated(document: Mapping[str, object], console: Console) -> None:
    if not document.get("simulations") and "sweep" not in document:
        return
    console.print()
    for line in lazy.module("simulated").lines(document):
        console.print(Text(line))


def heading(branch: Record) -> Text:
    """One line that says what the branch is: name, kind, parameters, origin."""
    kind, parameters = branch["kind"], " and ".join(branch["parameters"])
    points = locus_words(branch["locus"], branch["columns"])
    what = f"locus of {points}" if kind == "locus" else KINDS.get(kind, kind)
    origin = ""
    if branch["image_of"]:
        origin = f", the image of {branch['image_of']['branch']} under {branch['image_of']['symmetry']}"
    elif branch["parent"]:
        origin = f", from {branch['parent']['branch']}.{branch['parent']['label']}"
    rows = len(next(iter(branch["columns"].values()), []))
    varied = f" in {parameters}" if parameters else ""
    return Text.assemble((branch["name"], "bold cyan"), f"  {what}{varied}{origin}; {rows} points")


def _fitting(branch: Record, states: list[str], console: Console) -> Table:
    """The table with as many states as fit the console's width; with none, its words fold.

    Labels, parameters and coefficients are never shortened.
    """
    shown = _shown_columns(branch, states)
    for count in range(len(shown), len(branch["parameters"]) - 1, -1):
        table = _table(branch, shown[:count], fold=False)
        if Measurement.get(console, console.options.update(width=UNBOUNDED), table).maximum <= console.width:
            return table
    return _table(branch, list(branch["parameters"]), fold=True)


def _table(branch: Record, shown: list[str], *, fold: bool) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    table.add_column("  label", style="bold", no_wrap=True)
    table.add_column("type", no_wrap=not fold)
    for name in shown:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("coefficient", no_wrap=True)
    for point in branch["points"]:
        cells = [number(_known(branch, point, name)) for name in shown]
        table.add_row(f"  {point['label']}", words(point), *cells, _coefficient(point))
    return table


def _known(branch: Record, point: Record, name: str) -> float | None:
    """A value of a labelled point, 0 where it is no more than its error or a rounding error of the column."""
    value = point["values"].get(name)
    if value is None:
        return None
    errors = {branch["parameters"][0]: point.get("error"), **point.get("errors", {})} if branch["parameters"] else {}
    size = max((abs(x) for x in branch["columns"].get(name, ()) if x is not None), default=0.0)
    error = errors.get(name) or 0.0
    return 0.0 if abs(value) <= max(error if error <= UNSEEN * size else 0.0, EPSILON * size) else float(value)


def _shown_columns(branch: Record, states: list[str]) -> list[str]:
    """Parameters, free ones, the period, the first states: of orbits maxima; of cycles of maps their first points."""
    columns = branch["columns"]
    named = [next((name for name in (state, f"{state}.max") if name in columns), None) for state in states]
    period = ["period"] if "period" in columns else []
    free = [name for name in branch.get("free", ()) if name in columns]
    return [*branch["parameters"], *free, *period, *[name for name in named if name][:MOST_STATES]]


def words(point: Record) -> str:
    """The type of a point in words: 'Hopf point, subcritical'."""
    form = point["normal_form"]
    parts = [style_of(point["type"]).words]
    if form.get("kind") == "heteroclinic":  # of a HOM point, whose orbits tend to two saddles
        return parts[0].replace("homoclinic", "heteroclinic")
    parts += [str(form[key]) for key in ("kind", "criticality", "case") if form.get(key)]
    if form.get("of"):
        parts[-1] += f" of {form['of']}"
    if point.get("also"):
        parts.append(f"also {point['also']}")
    return ", ".join(parts)


def number(value: float | None) -> str:
    """Eight digits: enough to compare by eye; the JSON has all seventeen."""
    return "-" if value is None else f"{value:.8g}"


def _coefficient(point: Record) -> str:
    """The one that decides, with its error where that leaves no sign; of an extremum its height."""
    form = point["normal_form"]
    if form.get("of") in point["values"]:
        return f"{form['of']} = {number(point['values'][form['of']])}"
    for key in (_OF_KIND.get(str(form.get("kind")), ""), *_COEFFICIENTS):
        value, error = form.get(key), form.get("errors", {}).get(key)
        if isinstance(value, int | float) and not isinstance(value, bool):
            unsure = isinstance(error, int | float) and 0.0 < error >= abs(value)
            return f"{key} = {value:.4g}" + (f" +- {error:.1g}" if unsure else "")
        if isinstance(value, list) and len(value) == 2 and None not in value:
            return f"{key} = {value[0]:.4g}{value[1]:+.4g}i"
    return ""


def _print_notes(notes: Iterable[str], console: Console) -> None:
    notes = list(notes)
    if notes:
        console.print()
        console.print("Notes", style="bold")
    for note in notes:
        console.print(Text(f"  {note}"))


def _effort(document: Record) -> str:
    branches = [branch for branch in document["branches"] if not branch["image_of"]]
    steps, seconds = sum(b["steps"] for b in branches), sum(b["seconds"] for b in branches)
    timing = document["timing"]
    solved = [sum(b.get("effort", {}).get(name, 0) for b in branches) for name in ("factorisations", "applications")]
    solves = f" ({solved[0]} sparse factorisations, {solved[1]} solves)" if solved[1] else ""
    parts = ", ".join(f"{name} {timing[name]:.2f} s" for name in ("import", "lower", "kernels") if name in timing)
    count = f"{len(branches)} branch{'es' if len(branches) != 1 else ''}"
    return f"{count}, {steps} steps{solves} in {seconds:.3f} s; {parts}; {timing['total']:.2f} s in all"
