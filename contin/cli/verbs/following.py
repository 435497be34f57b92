"""Commands that continue solutions: run, diagram, phase, survey."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from contin.cli.clock import STARTED
from contin.cli.commands import work
from contin.cli.picture_options import Look, pictured
from contin.cli.verbs.app import app
from contin.cli.verbs.arguments import Csv, Json, ModelName, OrbitsToo, Page, Picture, Quiet, Sets, Starts, Store


@app.command()
def run(
    file: Annotated[Path, typer.Argument(help="Run file (YAML).")],
    json: Json = None,
    sets: Sets = None,
    orbits: OrbitsToo = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Finish a run that was killed, from the file of `outputs: save:`.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Carry out a run file: report on the terminal, pictures and files as its `outputs` say."""
    raise typer.Exit(work("run_file")(file, json, sets or [], orbits, quiet, STARTED, resume))


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
@pictured
def diagram(
    model: ModelName,
    parameter: Annotated[str, typer.Argument(help="Parameter to vary.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    start: Starts = None,
    sets: Sets = None,
    json: Json = None,
    plot: Picture = None,
    html: Page = None,
    x: Annotated[str | None, typer.Option("--x", "-x", help="Column for the horizontal axis.")] = None,
    y: Annotated[list[str] | None, typer.Option("--y", "-y", help="Vertical axis; repeat for more panels.")] = None,
    save: Store = None,
    budget: Annotated[
        list[str] | None,
        typer.Option("--budget", metavar="NAME=N", help="Stop after so many branches, steps or seconds. Repeatable."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--settings", metavar="NAME=VALUE", help="As in run files, such as max_step=0.1. Repeatable."),
    ] = None,
    no_orbits: Annotated[bool, typer.Option("--no-orbits", help="Do not follow periodic orbits.")] = False,
    orbits: OrbitsToo = False,
    quiet: Quiet = False,
    look: Look = None,
) -> None:
    """Explore a model's bifurcation diagram in one parameter automatically."""
    entry = {"parameter": parameter, "range": [low, high], "orbits": not no_orbits}
    entry |= {"start": start} if start else {}
    given = {"budget": budget or [], "settings": settings or []}
    files = {"plot": plot, "html": html, "save": save}
    drawn = {**(look or {}), "x": x, "y": y}
    raise typer.Exit(work("run_diagram")(model, entry, given, sets or [], json, files, orbits, quiet, STARTED, drawn))


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
@pictured
def phase(
    model: ModelName,
    first: Annotated[str, typer.Argument(metavar="P", help="Parameter of the horizontal axis.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    second: Annotated[str, typer.Argument(metavar="Q", help="Parameter of the vertical axis.")],
    bottom: Annotated[float, typer.Argument(metavar="LO")],
    top: Annotated[float, typer.Argument(metavar="HI")],
    start: Starts = None,
    sets: Sets = None,
    json: Json = None,
    plot: Picture = None,
    html: Page = None,
    save: Store = None,
    orbits: Annotated[bool, typer.Option(help="Periodic orbits and their curves, too.")] = True,
    quiet: Quiet = False,
    look: Look = None,
) -> None:
    """Cut a box of two parameters into regions by all curves of special points that can be reached."""
    ranges, files = ((low, high), (bottom, top)), {"plot": plot, "html": html, "save": save}
    raise typer.Exit(
        work("run_phase")(
            model, (first, second), ranges, start or [], sets or [], json, files, orbits, quiet, STARTED, look or {}
        )
    )


@app.command()
@pictured
def survey(
    model: ModelName,
    parameters: Annotated[
        list[str] | None, typer.Option("--parameter", "-p", help="Only this one. May be repeated.")
    ] = None,
    start: Starts = None,
    sets: Sets = None,
    factor: Annotated[float, typer.Option("--factor", help="Up to so many times the value, and down.")] = 10.0,
    most: Annotated[int, typer.Option("--attractors", help="Most attractors to start from.")] = 4,
    processes: Annotated[int | None, typer.Option("--processes", help="Default: one a core.")] = None,
    csv: Csv = None,
    plot: Picture = None,
    json: Json = None,
    quiet: Quiet = False,
    look: Look = None,
) -> None:
    """Which parameters matter: each varied both ways from every attractor, to the first bifurcation."""
    out = {"csv": csv, "plot": plot, "json": json, "look": look or {}}
    raise typer.Exit(
        work("survey_model")(
            model, parameters or [], start or [], sets or [], factor, most, processes, out, quiet, STARTED
        )
    )
