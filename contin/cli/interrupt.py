"""Ctrl-C, also while modules are imported: an exception raised there may be swallowed by the code it falls into."""

from __future__ import annotations

import signal
from types import FrameType


class _Interrupt:
    pressed = False

    def handle(self, number: int, frame: FrameType | None) -> None:
        self.pressed = True
        raise KeyboardInterrupt


_interrupt = _Interrupt()


def listen() -> None:
    """Take over Ctrl-C; where signals are not ours to take (another thread), Python's own handling stays."""
    _interrupt.pressed = False
    try:
        signal.signal(signal.SIGINT, _interrupt.handle)
    except ValueError:
        return


def check() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was pressed, whatever became of it then."""
    if _interrupt.pressed:
        raise KeyboardInterrupt
