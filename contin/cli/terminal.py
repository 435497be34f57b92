"""The consoles that reports and progress are printed on."""

from __future__ import annotations

from typing import NoReturn, TextIO

from rich.console import Console

from contin.cli.printable import PRINTABLE


class _Console(Console):
    def on_broken_pipe(self) -> NoReturn:
        """rich would end the program here, before it has written its files."""
        raise BrokenPipeError


def console(stream: TextIO, quiet: bool) -> Console:
    """A console of the terminal's width; a file or a pipe gets long lines instead of broken ones."""
    made = _Console(file=stream, quiet=quiet, highlight=False, width=None if stream.isatty() else 200, markup=False)
    made.push_render_hook(PRINTABLE)
    return made
