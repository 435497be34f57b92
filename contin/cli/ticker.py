"""A line of progress every few seconds, where there is no terminal for a moving one: in a pipe, a log of a queue."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rich.console import Console

EVERY: Final = 5.0  # seconds between two lines


class Ticker:
    """Prints the latest text, with the time since the beginning, every `EVERY` seconds; the first line after as long.

    From a thread of its own: kernels and long searches do not come back for minutes.
    """

    def __init__(self, console: Console) -> None:
        self._console, self._text = console, ""
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def update(self, text: object) -> None:
        """The text that is shown from now on."""
        self._text = str(text)

    def start(self) -> None:
        if self._console.quiet:
            return
        self._thread = threading.Thread(target=self._tick, daemon=True, name="contin progress")
        self._thread.start()

    def _tick(self) -> None:
        began = time.monotonic()
        while not self._ended.wait(EVERY):
            if self._text:
                self._console.print(f"{duration(time.monotonic() - began)}: {self._text}")

    def stop(self) -> None:
        self._ended.set()
        if self._thread is not None:
            self._thread.join(1.0)  # it may hang in a pipe that nobody reads


def duration(seconds: float) -> str:
    """Such as 40 s, 12 min, 3.5 h."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
