"""The command inside the test's process: what it says, and its exit code; an exception that escapes fails the test."""

import contextlib
import io
from dataclasses import dataclass
from typing import Any

from contin.cli.main import main


@dataclass(frozen=True)
class Answer:
    """Exit code, standard output and standard error."""

    code: int
    out: str
    err: str


def contin_command(*arguments: Any) -> Answer:
    """`contin ARGUMENTS`; the only way out of it is SystemExit."""
    out, err = io.StringIO(), io.StringIO()
    code: Any = "the command returned"
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as stopped:
            code = stopped.code or 0
    assert code in (0, 1, 2), (code, arguments, out.getvalue(), err.getvalue())
    return Answer(code, out.getvalue(), err.getvalue())
