"""The `contin` application, to which each file here adds its commands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any, Final

import typer
from typer.core import TyperGroup

from contin._version import __version__
from contin.cli.printable import printable

CLICK_ERROR: Final[Any] = typer.BadParameter.__mro__[2]  # typer's own copy of click in new versions: ClickException


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
