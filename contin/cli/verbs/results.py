"""Commands about results and the program itself: plot, export, orbit, kernels, schema."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from contin.cli.commands import work
from contin.cli.picture_options import Look, pictured
from contin.cli.verbs.app import app


@app.command()
@pictured
def plot(
    file: Annotated[Path, typer.Argument(help="Results: .contin, .json or .scan.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help=".png, .pdf, .svg or .html (default: FILE.png).")
    ] = None,
    x: Annotated[str | None, typer.Option("--x", "-x", help="Column for the horizontal axis.")] = None,
    y: Annotated[list[str] | None, typer.Option("--y", "-y", help="Vertical axis; repeat for more panels.")] = None,
    orbit: Annotated[
        str | None,
        typer.Option("--orbit", help="Draw the orbit at a point, BRANCH.LABEL: time series and phase portrait."),
    ] = None,
    over: Annotated[Path | None, typer.Option("--over", help="Curves to draw over a scan.")] = None,
    look: Look = None,
) -> None:
    """Draw saved results."""
    raise typer.Exit(work("plot_file")(file, out, x, y, over, orbit, look))


@app.command()
def export(
    file: Annotated[Path, typer.Argument(help="Results (.contin, .json, .scan) or a model file.")],
    out: Annotated[Path, typer.Argument(help="Results: .json, .csv or .nc. A model: the ending of another program.")],
) -> None:
    """Write saved results, or a model, in another format."""
    raise typer.Exit(work("export_file")(file, out))


@app.command()
def orbit(
    file: Annotated[Path, typer.Argument(help="Results: .contin, or .json written with --orbits.")],
    point: Annotated[str, typer.Argument(help="BRANCH.LABEL, such as cycles.LPC1.")],
    csv: Annotated[
        str | None, typer.Option("--csv", help="Write time and states over one period; - for standard output.")
    ] = None,
) -> None:
    """Tell the orbit at a labelled point: period, multipliers, extremes, samples."""
    raise typer.Exit(work("show_orbit")(file, point, csv))


@app.command()
def kernels(
    action: Annotated[str, typer.Argument(help="status, build (all of them, now), clear, or where.")] = "status",
) -> None:
    """The machine code of the numerical kernels: what is there, where it is kept, making it beforehand."""
    raise typer.Exit(work("kernels")(action))


@app.command()
def schema(
    what: Annotated[str, typer.Argument(help="model, pde, run, scan or result.")] = "run",
) -> None:
    """Print a JSON schema, for editors that check and complete YAML."""
    raise typer.Exit(work("print_schema")(what))
