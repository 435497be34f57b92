"""A clock for computing time: it stands still while kernels are compiled, or loaded from the cache.

What a branch takes, and what fits into a budget of seconds, is then the same on a machine's first run as later.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager


class Clock:
    """Wall-clock time without what happened inside `standing`, of which several may be nested or run in threads."""

    def __init__(self) -> None:
        self.stood = 0.0  # seconds, in all
        self.depth = 0
        self._began = 0.0
        self._lock = threading.Lock()

    def now(self) -> float:
        """Seconds from an arbitrary origin."""
        with self._lock:
            reading = self._began if self.depth else time.perf_counter()
            return reading - self.stood

    @contextmanager
    def standing(self) -> Iterator[None]:
        """Let the clock stand still."""
        with self._lock:
            if self.depth == 0:
                self._began = time.perf_counter()
            self.depth += 1
        try:
            yield
        finally:
            with self._lock:
                self.depth -= 1
                if self.depth == 0:
                    self.stood += time.perf_counter() - self._began


CLOCK = Clock()
computing_time = CLOCK.now
