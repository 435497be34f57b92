"""Commands that integrate: simulate, sweep, scan, plane."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from contin.cli.commands import work
from contin.cli.picture_options import Look, pictured
from contin.cli.verbs.app import app
from contin.cli.verbs.arguments import Csv, Json, ModelName, Picture, Quiet, Sets, StartName, States


@app.command()
@pictured
def simulate(
    model: ModelName,
    start: StartName = None,
    states: States = None,
    sets: Sets = None,
    time: Annotated[float, typer.Option("--time", "-t", help="How long (a map: iterations).")] = 100.0,
    transient: Annotated[float, typer.Option("--transient", help="Time before it that is not kept.")] = 0.0,
    samples: Annotated[int, typer.Option("--samples", help="Times the solution is kept at.")] = 5000,
    method: Annotated[str, typer.Option("--method", help="DOP853; for stiff flows Radau, LSODA or BDF.")] = "DOP853",
    rtol: Annotated[float, typer.Option("--rtol", help="Relative tolerance.")] = 1e-9,
    box: Annotated[float, typer.Option("--box", help="Stop where a state exceeds this.")] = 1e100,
    budget: Annotated[int, typer.Option("--budget", help="Most steps of the integrator.")] = 50_000_000,
    until: Annotated[
        str | None,
        typer.Option("--until", metavar="CONDITION", help="Stop where it becomes true, e.g. 'x > 2 and y < 0'."),
    ] = None,
    section: Annotated[
        str | None,
        typer.Option("--section", metavar="EXPRESSION", help="Poincare section, e.g. 'x = 1'."),
    ] = None,
    direction: Annotated[str, typer.Option("--direction", help="Of its crossings: up, down or both.")] = "up",
    csv: Csv = None,
    plot: Picture = None,
    x: Annotated[str | None, typer.Option("--x", "-x", help="Horizontal axis of the portrait.")] = None,
    y: Annotated[str | None, typer.Option("--y", "-y", help="Its vertical axis.")] = None,
    json: Json = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No table.")] = False,
    look: Look = None,
) -> None:
    """Integrate a model (iterate a map): table, CSV, time series and phase portrait."""
    out = {"csv": csv, "plot": plot, "json": json, "x": x, "y": y, "look": look or {}}
    raise typer.Exit(
        work("simulate_model")(
            model, start, states or [], sets or [], out, quiet,
            time=time, transient=transient, samples=samples, method=method, rtol=rtol, box=box,
            budget=budget, until=until,
            section=None if section is None else {"when": section, "direction": direction},
        )
    )  # fmt: skip


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
@pictured
def sweep(
    model: ModelName,
    parameter: Annotated[str, typer.Argument(help="Parameter to step.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    start: StartName = None,
    states: States = None,
    sets: Sets = None,
    measures: Annotated[
        list[str] | None,
        typer.Option("--measure", metavar="NAME=FORMULA", help="A quantity to record. May be repeated."),
    ] = None,
    steps: Annotated[int, typer.Option("--steps", help="Steps each way.")] = 60,
    window: Annotated[float | None, typer.Option("--window", help="Time over which settling is judged.")] = None,
    tolerance: Annotated[float | None, typer.Option("--tolerance", help="Change between windows.")] = None,
    longest: Annotated[float | None, typer.Option("--longest", help="Time at which waiting ends.")] = None,
    csv: Csv = None,
    plot: Picture = None,
    over: Annotated[Path | None, typer.Option("--over", help="Draw over these results (.contin or .json).")] = None,
    y: Annotated[
        list[str] | None, typer.Option("--y", "-y", help="Quantity to draw; repeat for more panels.")
    ] = None,
    json: Json = None,
    quiet: Quiet = False,
    look: Look = None,
) -> None:
    """Step a parameter up and down, each run started from the last state: hysteresis."""
    waiting = {"window": window, "tolerance": tolerance, "longest": longest}
    out = {"csv": csv, "plot": plot, "json": json, "y": y, "look": look or {}}
    raise typer.Exit(
        work("sweep_model")(
            model, parameter, low, high, start, states or [], sets or [], measures or [], steps, waiting, out, over,
            quiet,
        )
    )  # fmt: skip


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
@pictured
def lyapunov(
    model: ModelName,
    parameter: Annotated[str | None, typer.Argument(help="Parameter to step; left out: one trajectory.")] = None,
    low: Annotated[float | None, typer.Argument(metavar="LO")] = None,
    high: Annotated[float | None, typer.Argument(metavar="HI")] = None,
    points: Annotated[int, typer.Option("--points", help="Values of the parameter.")] = 61,
    count: Annotated[
        int | None, typer.Option("--count", help="Exponents, from the largest (default: all of up to 10 states).")
    ] = None,
    start: StartName = None,
    states: States = None,
    sets: Sets = None,
    time: Annotated[
        float | None, typer.Option("--time", "-t", help="That means are taken over (a map: iterates).")
    ] = None,
    transient: Annotated[float | None, typer.Option("--transient", help="Time before it (default: a fifth).")] = None,
    rtol: Annotated[float, typer.Option("--rtol", help="Relative tolerance.")] = 1e-9,
    csv: Csv = None,
    plot: Picture = None,
    json: Json = None,
    quiet: Quiet = False,
    look: Look = None,
) -> None:
    """Lyapunov exponents of a trajectory, with errors; along a parameter, each from the last state."""
    options = {"time": time, "transient": transient, "count": count, "rtol": rtol}
    out = {"csv": csv, "plot": plot, "json": json, "look": look or {}}
    raise typer.Exit(
        work("exponents_of_model")(
            model, (parameter, low, high, points), start, states or [], sets or [], options, out, quiet
        )
    )


@app.command()
def scan(
    file: Annotated[Path, typer.Argument(help="Scan file (YAML).")],
    json: Json = None,
    sets: Sets = None,
    threads: Annotated[int | None, typer.Option("--threads", help="Default: one a core.")] = None,
    cluster: Annotated[
        str | None,
        typer.Option("--cluster", metavar="tcp://HOST:PORT", help="A dask.distributed scheduler to share the runs."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Finish a scan that was killed, from the file of `outputs: save:`.")
    ] = False,
    over: Annotated[
        Path | None,
        typer.Option("--over", help="Draw the curves of these results (.contin or .json) over the picture."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Simulate over a grid of parameters or initial states, several starts each, and name what each settles on."""
    raise typer.Exit(work("scan_file")(file, json, sets or [], threads, cluster, resume, over, quiet))


@app.command(context_settings={"ignore_unknown_options": True})  # ends and points may be negative
def plane(
    model: ModelName,
    x: Annotated[str, typer.Argument(metavar="X", help="State of the horizontal axis.")],
    y: Annotated[str, typer.Argument(metavar="Y", help="State of the vertical axis.")],
    x_range: Annotated[
        tuple[float, float] | None, typer.Option("--x", metavar="LO HI", help="Ends of the horizontal axis.")
    ] = None,
    y_range: Annotated[
        tuple[float, float] | None, typer.Option("--y", metavar="LO HI", help="Ends of the vertical axis.")
    ] = None,
    points: Annotated[
        list[str] | None, typer.Option("--from", metavar="X,Y", help="Draw the trajectory from here. May be repeated.")
    ] = None,
    at: Annotated[
        list[str] | None, typer.Option("--at", metavar="NAME=VALUE", help="Value of another state, which is held.")
    ] = None,
    sets: Sets = None,
    start: Annotated[str | None, typer.Option("--start", help="Named start, for the states that are held.")] = None,
    along: Annotated[
        tuple[str, float, float] | None,
        typer.Option("--parameter", metavar="NAME LO HI", help="A page with a slider over this parameter."),
    ] = None,
    frames: Annotated[int, typer.Option("--frames", help="Planes along the parameter.")] = 21,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help=".png, .pdf, .svg or .html (default: MODEL-plane.png).")
    ] = None,
    json: Json = None,
    quiet: Quiet = False,
) -> None:
    """The phase plane of two states: nullclines, directions, equilibria, separatrices, cycles, trajectories."""
    window = {"x_range": x_range, "y_range": y_range}
    raise typer.Exit(
        work("plane_of_model")(
            model, x, y, window, points or [], at or [], sets or [], start, along, frames, out, json, quiet
        )
    )
