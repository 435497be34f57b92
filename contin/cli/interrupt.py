"""Ctrl-C, also while modules are imported: an exception raised there may be swallowed by the code it falls into."""

from __future__ import annotations

import signal
import sys
from types import FrameType


class _Interrupt:
    pressed = False
    holding = False

    def handle(self, number: int, frame: FrameType | None) -> None:
        if self.holding:
            self.holding = False
            sys.stderr.write("writing what was computed; Ctrl-C again gives it up\n")
            return
        self.pressed = True
        raise KeyboardInterrupt


_interrupt = _Interrupt()


def listen() -> None:
    """Take over Ctrl-C; where signals are not ours to take (another thread), Python's own handling stays."""
    _interrupt.pressed = _interrupt.holding = False
    try:
        signal.signal(signal.SIGINT, _interrupt.handle)
    except ValueError:
        return


def hold() -> None:
    """From now on the first Ctrl-C is answered in words only: results are being written."""
    _interrupt.holding = True


def check() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was pressed, whatever became of it then."""
    if _interrupt.pressed:
        raise KeyboardInterrupt
