"""A process of its own for the picture of a run: it imports matplotlib while the run computes, and draws while the run
writes its other files.

matplotlib takes longer to import than most runs take to compute. The drawer is a copy of this process that is made
before the computation; it gets the result document as JSON, in which numbers keep every digit, and gives the bytes of
the picture. Whatever goes wrong with it, the picture is drawn by the run itself, which then says what is wrong.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import FileIO
from typing import TYPE_CHECKING, Final

from contin.cli.commands import imported
from contin.cli.drawing import load_matplotlib
from contin.plot.look import Look
from contin.plot.write import picture

if TYPE_CHECKING:
    from contin.records import Record
    from contin.runs.plans import Plan

SIGNALS: Final = ("SIGINT", "SIGTERM", "SIGHUP")


class Drawer:
    """The process, as the run sees it."""

    def __init__(self, process: int, question: FileIO, answer: FileIO) -> None:
        self.process, self._question, self._answer = process, question, answer

    def begin(self, document: Record) -> None:
        """Have the picture of these results drawn."""
        with suppress(OSError, ValueError), self._question:
            write_whole(self._question, json.dumps(document, allow_nan=False).encode())

    def picture(self) -> bytes | None:
        """The picture when it is drawn; None where this process has to draw it."""
        with suppress(OSError):
            return self._answer.readall() or None
        return None

    def dismiss(self) -> None:
        """End the process, whatever it does."""
        for end in (self._question, self._answer):
            with suppress(OSError):
                end.close()
        with suppress(OSError):
            os.kill(self.process, signal.SIGKILL)
            os.waitpid(self.process, 0)


@contextmanager
def drawer_of(plan: Plan) -> Iterator[Drawer | None]:
    """The drawer of a plan with a picture of its branches; None where a second process has nothing to save."""
    path = plan.outputs.get("plot")
    drawer = begun(path.suffix, Look.of(plan.look)) if path is not None and plan.sweep is None and _saves() else None
    try:
        yield drawer
    finally:
        if drawer is not None:
            drawer.dismiss()


def _saves() -> bool:
    """On Linux, on two processors or more, where matplotlib is not there yet and no thread would be cut in two."""
    return (
        sys.platform == "linux"
        and len(os.sched_getaffinity(0)) > 1
        and "matplotlib.figure" not in sys.modules
        and threading.active_count() == 1
    )


def begun(suffix: str, look: Look) -> Drawer | None:
    """A process that waits for a document; None where there can be none."""
    try:
        (asked, question), (answer, answered) = os.pipe(), os.pipe()
        process = os.fork()
    except OSError:
        return None
    if process == 0:
        try:
            os.close(question)
            os.close(answer)
            _draw(FileIO(asked), FileIO(answered, "w"), suffix, look)
        finally:
            os._exit(0)  # what this copy has not printed is the other one's to print
    os.close(asked)
    os.close(answered)
    return Drawer(process, FileIO(question, "w"), FileIO(answer))


def _draw(asked: FileIO, answered: FileIO, suffix: str, look: Look) -> None:
    """What the process does; where it fails there is no answer."""
    for name in SIGNALS:  # the run is asked to stop, and dismisses it when it has no use for it
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    load_matplotlib()
    imported("matplotlib.backends.backend_agg")
    document = asked.readall()
    if document:
        write_whole(answered, picture(json.loads(document), suffix, look))


def write_whole(end: FileIO, data: bytes) -> None:
    """Write all of it to a pipe, which takes 64 kB at a time."""
    rest = memoryview(data)
    while rest:
        rest = rest[end.write(rest) or 0 :]
