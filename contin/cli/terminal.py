"""Standard output that fails: a full disk behind it, or a reader that has gone (`contin run FILE | head`)."""

from __future__ import annotations

import os
import sys
from typing import NoReturn, TextIO

from rich.console import Console

from contin.cli.printable import PRINTABLE


def forget_output() -> None:
    """What standard output could not take is not tried again, with a complaint, when Python ends."""
    try:
        with open(os.devnull, "w", encoding="utf-8") as nowhere:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
    except (OSError, ValueError):  # standard output is no file: a test's or a notebook's
        return


def trouble(error: OSError) -> str:
    """What went wrong, in words: the file, where the error names one, and the reason."""
    return f"{error.filename or 'standard output'}: {error.strerror or error}"


class _Console(Console):
    def on_broken_pipe(self) -> NoReturn:
        """rich would end the program here, before it has written its files."""
        raise BrokenPipeError


def console(stream: TextIO, quiet: bool) -> Console:
    """A console of the terminal's width; a file or a pipe gets long lines instead of broken ones."""
    made = _Console(file=stream, quiet=quiet, highlight=False, width=None if stream.isatty() else 200, markup=False)
    made.push_render_hook(PRINTABLE)
    return made
