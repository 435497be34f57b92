"""Commands about models: check, models, show, derive, new, import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from contin.cli.commands import work
from contin.cli.verbs.app import app
from contin.cli.verbs.arguments import ModelName


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
def show(
    model: ModelName,
    latex: Annotated[bool, typer.Option("--latex", help="As LaTeX.")] = False,
    yaml: Annotated[bool, typer.Option("--yaml", help="As a model file.")] = False,
) -> None:
    """Print the equations of a model."""
    raise typer.Exit(work("show_model")(model, latex, yaml))


@app.command()
def derive(
    model: ModelName,
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
def new(
    name: Annotated[str, typer.Argument(help="Name of the model; NAME.yaml and NAME-run.yaml are written here.")],
) -> None:
    """Write a small model file and a run file for it, ready to change."""
    raise typer.Exit(work("write_templates")(name))


@app.command("import")
def import_(
    file: Annotated[Path, typer.Argument(help="A model in the format of another program.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Model file to write (default: standard output).")
    ] = None,
) -> None:
    """Write a model of another program as a model file (YAML)."""
    raise typer.Exit(work("import_model")(file, out))
