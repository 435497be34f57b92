"""The `contin` command: what can be typed. Each command's work is in its own file, imported only when it runs."""

from __future__ import annotations

import time

STARTED = time.perf_counter()  # before any import of ours: reports count imports too

import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Final

import typer
from typer.core import TyperGroup

from contin._version import __version__
from contin.cli.commands import work
from contin.cli.interrupt import exit_code, listen
from contin.cli.printable import printable
from contin.cli.streams import guarded_streams
from contin.errors import ContinError
from contin.machine import environment
from contin.store.digest import DamageWarning, LeftOutWarning

CLICK_ERROR: Final[Any] = typer.BadParameter.__mro__[2]  # typer's own copy of click in new versions: ClickException
CUT_SHORT, BAD_INPUT, INTERRUPTED = 1, 2, 130


class _Commands(TyperGroup):
    """The commands; what they say of an argument has no control characters of it."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        with _printable_errors():
            return list(super().parse_args(ctx, args))

    def invoke(self, ctx: Any) -> Any:
        with _printable_errors():
            return super().invoke(ctx)


@contextmanager
def _printable_errors() -> Iterator[None]:
    try:
        yield
    except CLICK_ERROR as error:
        error.message = printable(error.message)
        raise


app = typer.Typer(
    name="contin",
    cls=_Commands,
    help="Numerical continuation and bifurcation analysis.",
    no_args_is_help=True,
    add_completion=True,  # --install-completion and --show-completion for bash, zsh, fish
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Exit codes: 0 done; 1 a branch was cut short or skipped, or an output failed; 2 bad input.",
)

Sets = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter's value; wins over every file. May be repeated."),
]
Json = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="OUT", help="Write the results as JSON to this file, or to standard output for '-'."
    ),
]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"contin {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command()
def run(
    file: Annotated[Path, typer.Argument(help="Run file (YAML).")],
    json: Json = None,
    sets: Sets = None,
    orbits: Annotated[
        bool, typer.Option("--orbits", help="Add the orbit itself to every labelled point in the JSON.")
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Finish a run that was killed, from the file of `outputs: save:`.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Carry out a run file: report on the terminal, pictures and files as its `outputs` say."""
    raise typer.Exit(work("run_file")(file, json, sets or [], orbits, quiet, STARTED, resume))


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
def diagram(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    parameter: Annotated[str, typer.Argument(help="Parameter to vary.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    start: Annotated[list[str] | None, typer.Option("--start", help="Named start. May be repeated.")] = None,
    sets: Sets = None,
    json: Json = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the diagram: .png, .pdf or .svg.")] = None,
    html: Annotated[Path | None, typer.Option("--html", help="Write an interactive page: .html.")] = None,
    save: Annotated[Path | None, typer.Option("--save", help="Save the results: .contin.")] = None,
    budget: Annotated[
        list[str] | None,
        typer.Option("--budget", metavar="NAME=N", help="Stop after so many branches, steps or seconds. Repeatable."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--settings", metavar="NAME=VALUE", help="As in run files, such as max_step=0.1. Repeatable."),
    ] = None,
    no_orbits: Annotated[bool, typer.Option("--no-orbits", help="Do not follow periodic orbits.")] = False,
    orbits: Annotated[
        bool, typer.Option("--orbits", help="Add the orbit itself to every labelled point in the JSON.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Explore a model's bifurcation diagram in one parameter automatically."""
    entry = {"parameter": parameter, "range": [low, high], "orbits": not no_orbits}
    entry |= {"start": start} if start else {}
    given = {"budget": budget or [], "settings": settings or []}
    files = {"plot": plot, "html": html, "save": save}
    raise typer.Exit(work("run_diagram")(model, entry, given, sets or [], json, files, orbits, quiet, STARTED))


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
def phase(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    first: Annotated[str, typer.Argument(metavar="P", help="Parameter of the horizontal axis.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    second: Annotated[str, typer.Argument(metavar="Q", help="Parameter of the vertical axis.")],
    bottom: Annotated[float, typer.Argument(metavar="LO")],
    top: Annotated[float, typer.Argument(metavar="HI")],
    start: Annotated[list[str] | None, typer.Option("--start", help="Named start. May be repeated.")] = None,
    sets: Sets = None,
    json: Json = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the diagram: .png, .pdf or .svg.")] = None,
    html: Annotated[Path | None, typer.Option("--html", help="Write an interactive page.")] = None,
    save: Annotated[Path | None, typer.Option("--save", help="Write a store (.contin).")] = None,
    orbits: Annotated[bool, typer.Option(help="Periodic orbits and their curves, too.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Cut a box of two parameters into regions by all curves of special points that can be reached."""
    ranges, files = ((low, high), (bottom, top)), {"plot": plot, "html": html, "save": save}
    raise typer.Exit(
        work("run_phase")(model, (first, second), ranges, start or [], sets or [], json, files, orbits, quiet, STARTED)
    )


@app.command()
def simulate(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    start: Annotated[str | None, typer.Option("--start", help="Named start.")] = None,
    states: Annotated[
        list[str] | None,
        typer.Option("--state", metavar="NAME=VALUE", help="A state's initial value. May be repeated."),
    ] = None,
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
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw it: .png, .pdf or .svg.")] = None,
    x: Annotated[str | None, typer.Option("--x", "-x", help="Horizontal axis of the portrait.")] = None,
    y: Annotated[str | None, typer.Option("--y", "-y", help="Its vertical axis.")] = None,
    json: Json = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No table.")] = False,
) -> None:
    """Integrate a model (iterate a map): table, CSV, time series and phase portrait."""
    out = {"csv": csv, "plot": plot, "json": json, "x": x, "y": y}
    raise typer.Exit(
        work("simulate_model")(
            model, start, states or [], sets or [], out, quiet,
            time=time, transient=transient, samples=samples, method=method, rtol=rtol, box=box,
            budget=budget, until=until,
            section=None if section is None else {"when": section, "direction": direction},
        )
    )  # fmt: skip


@app.command(context_settings={"ignore_unknown_options": True})  # LO may be negative
def sweep(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    parameter: Annotated[str, typer.Argument(help="Parameter to step.")],
    low: Annotated[float, typer.Argument(metavar="LO")],
    high: Annotated[float, typer.Argument(metavar="HI")],
    start: Annotated[str | None, typer.Option("--start", help="Named start.")] = None,
    states: Annotated[
        list[str] | None,
        typer.Option("--state", metavar="NAME=VALUE", help="A state's initial value. May be repeated."),
    ] = None,
    sets: Sets = None,
    measures: Annotated[
        list[str] | None,
        typer.Option("--measure", metavar="NAME=FORMULA", help="A quantity to record. May be repeated."),
    ] = None,
    steps: Annotated[int, typer.Option("--steps", help="Steps each way.")] = 60,
    window: Annotated[float | None, typer.Option("--window", help="Time over which settling is judged.")] = None,
    tolerance: Annotated[float | None, typer.Option("--tolerance", help="Change between windows.")] = None,
    longest: Annotated[float | None, typer.Option("--longest", help="Time at which waiting ends.")] = None,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw it: .png, .pdf or .svg.")] = None,
    over: Annotated[Path | None, typer.Option("--over", help="Draw over these results (.contin or .json).")] = None,
    y: Annotated[str | None, typer.Option("--y", "-y", help="Quantity to draw.")] = None,
    json: Json = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Step a parameter up and down, each run started from the last state: hysteresis."""
    waiting = {"window": window, "tolerance": tolerance, "longest": longest}
    out = {"csv": csv, "plot": plot, "json": json, "y": y}
    raise typer.Exit(
        work("sweep_model")(
            model, parameter, low, high, start, states or [], sets or [], measures or [], steps, waiting, out, over,
            quiet,
        )
    )  # fmt: skip


@app.command(context_settings={"ignore_unknown_options": True})  # ends and points may be negative
def plane(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
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
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """The phase plane of two states: nullclines, directions, equilibria, separatrices, cycles, trajectories."""
    window = {"x_range": x_range, "y_range": y_range}
    raise typer.Exit(
        work("plane_of_model")(
            model, x, y, window, points or [], at or [], sets or [], start, along, frames, out, json, quiet
        )
    )


@app.command()
def survey(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    parameters: Annotated[
        list[str] | None, typer.Option("--parameter", "-p", help="Only this one. May be repeated.")
    ] = None,
    start: Annotated[list[str] | None, typer.Option("--start", help="Named start. May be repeated.")] = None,
    sets: Sets = None,
    factor: Annotated[float, typer.Option("--factor", help="Up to so many times the value, and down.")] = 10.0,
    most: Annotated[int, typer.Option("--attractors", help="Most attractors to start from.")] = 4,
    processes: Annotated[int | None, typer.Option("--processes", help="Default: one a core.")] = None,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw it: .png, .pdf or .svg.")] = None,
    json: Json = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Which parameters matter: each varied both ways from every attractor, to the first bifurcation."""
    out = {"csv": csv, "plot": plot, "json": json}
    raise typer.Exit(
        work("survey_model")(
            model, parameters or [], start or [], sets or [], factor, most, processes, out, quiet, STARTED
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
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")] = False,
) -> None:
    """Simulate over a grid of parameters or initial states, several starts each, and name what each settles on."""
    raise typer.Exit(work("scan_file")(file, json, sets or [], threads, cluster, resume, over, quiet))


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="Run file, scan file or model file (YAML), or results.")],
    execute: Annotated[bool, typer.Option("--run", help="Carry out the model's `expect:` and compare.")] = False,
) -> None:
    """Check a run file, a model file or saved results without computing; say what is wrong and where."""
    raise typer.Exit(work("check_file")(file, execute))


@app.command()
def models() -> None:
    """List the bundled and plugin models."""
    raise typer.Exit(work("list_models")())


@app.command()
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
    log: Annotated[list[str] | None, typer.Option("--log", help="Column with a logarithmic axis; repeatable.")] = None,
    limits: Annotated[
        list[str] | None, typer.Option("--limits", help="COLUMN=LOW,HIGH: ends of an axis; repeatable.")
    ] = None,
    labels: Annotated[
        str | None, typer.Option("--labels", help="Types whose labels are written, such as LP,HB; or none.")
    ] = None,
    size: Annotated[str | None, typer.Option("--size", help="WIDTH,HEIGHT in inches.")] = None,
    legend: Annotated[str, typer.Option("--legend", help="below, inside or none.")] = "below",
    title: Annotated[str | None, typer.Option("--title", help="Written over the picture.")] = None,
) -> None:
    """Draw saved results."""
    look = {"log": log, "limits": limits, "labels": labels, "size": size, "legend": legend, "title": title}
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


@app.command("import")
def import_(
    file: Annotated[Path, typer.Argument(help="A model in the format of another program.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Model file to write (default: standard output).")
    ] = None,
) -> None:
    """Write a model of another program as a model file (YAML)."""
    raise typer.Exit(work("import_model")(file, out))


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the model; NAME.yaml and NAME-run.yaml are written here.")],
) -> None:
    """Write a small model file and a run file for it, ready to change."""
    raise typer.Exit(work("write_templates")(name))


@app.command()
def derive(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    form: Annotated[str, typer.Option("--form", help="polar, cartesian or stokes.")] = "polar",
    time: Annotated[str, typer.Option("--time", help="slow (small parameter times t) or fast.")] = "slow",
    order: Annotated[int, typer.Option("--order", help="1 or 2.")] = 1,
    latex: Annotated[Path | None, typer.Option("--latex", help="Write a LaTeX document.")] = None,
    markdown: Annotated[Path | None, typer.Option("--markdown", help="Write Markdown.")] = None,
    save: Annotated[Path | None, typer.Option("--save", help="Write the averaged model as a model file.")] = None,
) -> None:
    """Average a model of weakly nonlinear oscillators and print the derivation, step by step."""
    raise typer.Exit(work("derive_model")(model, form, time, order, latex, markdown, save))


@app.command()
def show(
    model: Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")],
    latex: Annotated[bool, typer.Option("--latex", help="As LaTeX.")] = False,
    yaml: Annotated[bool, typer.Option("--yaml", help="As a model file.")] = False,
) -> None:
    """Print the equations of a model."""
    raise typer.Exit(work("show_model")(model, latex, yaml))


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


class _Warned:
    """Shows warnings without the line of code that makes them, which is none of the user's; `left_out`: of results."""

    def __init__(self) -> None:
        self.left_out = False

    def __call__(self, message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
        self.left_out |= issubclass(category, LeftOutWarning)
        sys.stderr.write(f"warning: {printable(str(message))}\n")


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: bad input ends with one message and exit code 2, never with a traceback.

    What standard output could not take is named at the end, with exit code 1: nothing else is lost by it.
    """
    environment.fix()
    listen()
    with guarded_streams() as out:
        code = _exit_code(arguments)
        out.flush()
        if out.failure:
            sys.stderr.write(f"standard output: {out.failure}\n")
            code = code or CUT_SHORT
    raise SystemExit(code)


def _stopped() -> int:
    sys.stderr.write("stopped\n")
    return exit_code()


def _exit_code(arguments: Sequence[str] | None) -> int:
    warned = _Warned()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", DamageWarning)
            warnings.showwarning = warned
            app(arguments, prog_name="contin")
    except ContinError as error:
        sys.stderr.write(f"{printable(str(error))}\n")
        return BAD_INPUT
    except OSError as error:  # files say so themselves where they are written
        sys.stderr.write(printable(f"{error.filename or 'contin'}: {error.strerror or error}") + "\n")
        return BAD_INPUT
    except KeyboardInterrupt:
        return _stopped()
    except SystemExit as end:  # of typer: an exit code, or words
        if end.code == INTERRUPTED:  # what typer makes of a KeyboardInterrupt
            return _stopped()
        if isinstance(end.code, str):
            sys.stderr.write(f"{end.code}\n")
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
        return code or int(warned.left_out)
    return 0
