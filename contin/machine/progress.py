"""What is said while kernels are made: one line on standard error, which a listener can take over."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """How far the making of kernels has come."""

    done: int
    total: int
    kernel: str
    """The one that was finished last; empty at the beginning."""


Listener = Callable[[Progress], None]
_listeners: list[Listener] = []


@contextmanager
def telling(listener: Listener) -> Iterator[None]:
    """Call `listener` whenever kernels begin to be made or one is finished, instead of writing a line."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def tell(done: int, total: int, kernel: str = "") -> None:
    """Say how far it has come."""
    if _listeners:
        _listeners[-1](Progress(done, total, kernel))
    elif not _quiet() and sys.stderr is not None:
        _write(done, total)


def note(text: str) -> None:
    """Something about machine code that a user should know and that stops nothing."""
    if not _quiet() and sys.stderr is not None:
        print(f"contin: {text}", file=sys.stderr)  # noqa: T201  # the one line that Python users see


def _quiet() -> bool:
    return bool(os.environ.get("CONTIN_QUIET"))


def _write(done: int, total: int) -> None:
    text = f"contin: making machine code, once for this machine: {done} of {total}"
    if sys.stderr.isatty():
        sys.stderr.write("\r" + text + ("\n" if done == total else ""))
    elif done == 0:
        sys.stderr.write(text.rpartition(":")[0] + f" ({total} kernels)\n")
    sys.stderr.flush()
