"""Errors that contin did not foresee: they cost only what was being computed, and are told with their place."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from contin.errors import ContinError

PACKAGE: Final = Path(__file__).resolve().parents[1]
DEFECT: Final = "an error inside contin"


def described(error: BaseException) -> str:
    """The error with the line of contin that it passed last (that of a library says little), fit for a report."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [(Path(frame.filename), frame.lineno) for frame in frames if PACKAGE in Path(frame.filename).parents]
    where = ""
    if own:
        path, line = own[-1]
        where = f" at {path.relative_to(PACKAGE.parent).as_posix()}:{line}"
    return f"{DEFECT}{where}, please report it: {type(error).__name__}: {error}"


@contextmanager
def contained(tell: Callable[[str], object]) -> Iterator[None]:
    """What is inside ends with an error that contin did not foresee, and `tell` gets it in words.

    Not so the errors that contin raises on purpose, those of files and memory, and Ctrl-C: they pass.
    """
    try:
        yield
    except (ContinError, OSError, MemoryError):
        raise
    except Exception as error:  # noqa: BLE001 - a defect must not lose what was computed before and beside it
        tell(described(error))


@contextmanager
def noted(tell: Callable[[str], object]) -> Iterator[None]:
    """What is inside ends with any error but those of files and memory, and `tell` gets it in words."""
    try:
        with contained(tell):
            yield
    except ContinError as error:
        tell(str(error))
