"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
ModelName = Annotated[str, typer.Argument(help="Bundled or plugin name, or a model file.")]
StartName = Annotated[str | None, typer.Option("--start", help="Named start.")]
Starts = Annotated[list[str] | None, typer.Option("--start", help="Named start. May be repeated.")]
States = Annotated[
    list[str] | None,
    typer.Option("--state", metavar="NAME=VALUE", help="A state's initial value. May be repeated."),
]
OrbitsToo = Annotated[bool, typer.Option("--orbits", help="Add the orbit itself to every labelled point in the JSON.")]
Csv = Annotated[Path | None, typer.Option("--csv", help="Write the table.")]
Picture = Annotated[Path | None, typer.Option("--plot", help="Draw it: .png, .pdf or .svg.")]
Page = Annotated[Path | None, typer.Option("--html", help="Write an interactive page: .html.")]
Store = Annotated[Path | None, typer.Option("--save", help="Save the results: .contin.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No report and no progress.")]
