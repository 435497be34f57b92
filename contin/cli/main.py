"""The `contin` command: its commands are in `contin.cli.verbs`."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from functools import cache
from typing import Any

import typer

from contin.cli.clock import STARTED  # noqa: F401 - before all other imports
from contin.cli.interrupt import exit_code, listen
from contin.cli.printable import printable
from contin.cli.streams import guarded_streams
from contin.cli.verbs import following, in_time, models, results  # noqa: F401 - commands register themselves
from contin.cli.verbs.app import app
from contin.errors import ContinError
from contin.machine import environment
from contin.store.digest import DamageWarning, LeftOutWarning

CUT_SHORT, BAD_INPUT, INTERRUPTED = 1, 2, 130


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


@cache
def _command() -> Any:
    """The application with all its options, which takes 40 ms to make: once in a process."""
    return typer.main.get_command(app)


def _stopped() -> int:
    sys.stderr.write("stopped\n")
    return exit_code()


def _exit_code(arguments: Sequence[str] | None) -> int:
    warned = _Warned()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", DamageWarning)
            warnings.showwarning = warned
            _command()(arguments, prog_name="contin")
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
