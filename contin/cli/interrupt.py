"""Being asked to stop: Ctrl-C, SIGTERM (queues, `timeout`, `kill`) and SIGHUP (a terminal that was closed).

Each is answered by a KeyboardInterrupt, once: what was computed is kept and written. An exception raised while modules
are imported may be swallowed by the code it falls into, so `check` raises it again at the next safe place. `timeout`
and queues send their signals several times: after the first only an impatient Ctrl-C counts.
"""

from __future__ import annotations

import signal
import sys
import time
from types import FrameType
from typing import Final

PATIENCE: Final = 1.0  # seconds after the first in which a second Ctrl-C is taken for the same press


class _Interrupt:
    pressed = False
    holding = False
    number: int = signal.SIGINT
    at = 0.0

    def handle(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self.holding:
            if number == signal.SIGINT:
                self.holding = False
                sys.stderr.write("writing what was computed; Ctrl-C again gives it up\n")
            return
        if self.pressed and (number != signal.SIGINT or now - self.at < PATIENCE):
            return
        if not self.pressed:
            self.number = number
        self.pressed, self.at = True, now
        raise KeyboardInterrupt


_interrupt = _Interrupt()


def listen() -> None:
    """Take over the signals; where they are not ours to take (another thread), Python's own handling stays.

    A SIGHUP that is ignored (`nohup`) stays ignored.
    """
    _interrupt.pressed = _interrupt.holding = False
    _interrupt.at = 0.0
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)  # Windows has no SIGHUP
        if number is None or (name == "SIGHUP" and signal.getsignal(number) is signal.SIG_IGN):
            continue
        try:
            signal.signal(number, _interrupt.handle)
        except ValueError:
            return


def hold() -> None:
    """From now on the first Ctrl-C is answered in words only, and other signals not at all: results are written."""
    _interrupt.holding = True


def check() -> None:
    """Raise KeyboardInterrupt if the program was asked to stop, whatever became of it then."""
    if _interrupt.pressed:
        raise KeyboardInterrupt


def exit_code() -> int:
    """Of a program that was ended before it had a result: 128 + the signal's number."""
    return 128 + _interrupt.number
