"""Progress of many equal runs: done, in all, time left."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from contin.cli.ticker import Ticker, duration

if TYPE_CHECKING:
    from rich.console import Console


@contextmanager
def counted(text: str, console: Console) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left (without a terminal: a line now and then); the function is called with (done, all)."""
    if console.quiet:
        yield lambda done, total: None
    elif not console.is_terminal:
        ticker = Ticker(console)
        ticker.update(text)
        ticker.start()
        try:
            yield _lines(text, ticker)
        finally:
            ticker.stop()
    else:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task(text, total=None)
            yield lambda done, total: progress.update(task, completed=done, total=total)


def _lines(text: str, ticker: Ticker) -> Callable[[int, int], None]:
    began = time.monotonic()
    first: int | None = None

    def tell(done: int, total: int) -> None:
        nonlocal first
        first = done - 1 if first is None else first
        left = (time.monotonic() - began) / (done - first) * (total - done)
        ticker.update(f"{text}: {done} of {total}, {duration(left)} left")

    return tell
