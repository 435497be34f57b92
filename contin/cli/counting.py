"""Progress of many equal runs: done, in all, time left."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

EVERY: Final = 30.0  # seconds between two lines where there is no terminal


@contextmanager
def counted(text: str, console: Any) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left (without a terminal: a line now and then); the function is called with (done, all)."""
    if console.quiet:
        yield lambda done, total: None
    elif not console.is_terminal:
        yield _lines(text, console)
    else:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task(text, total=None)
            yield lambda done, total: progress.update(task, completed=done, total=total)


def _lines(text: str, console: Any) -> Callable[[int, int], None]:
    began = last = time.monotonic()
    first: int | None = None

    def tell(done: int, total: int) -> None:
        nonlocal last, first
        first = done - 1 if first is None else first
        now = time.monotonic()
        if now - last >= EVERY and done < total:
            left = (now - began) / (done - first) * (total - done)
            console.print(f"{text}: {done} of {total}, {duration(left)} left")
            last = now

    return tell


def duration(seconds: float) -> str:
    """Such as 40 s, 12 min, 3.5 h."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
