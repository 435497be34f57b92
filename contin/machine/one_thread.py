"""One thread for the linear algebra of small matrices, whatever the libraries would take.

Threads of BLAS wait for each other at every call: on a machine that does something else too, or whose processors are
rationed, an elimination of 150 unknowns takes 100 ms in place of 1. The command `contin` has one thread from the start
(`contin.machine.environment`); a program that imports numpy itself has as many as there are processors, and gets them
back when a branch is done. Who has set one of the variables by which users choose has chosen.
"""

from __future__ import annotations

import os
import sys
from contextlib import ContextDecorator, ExitStack
from threading import Lock
from typing import TYPE_CHECKING, Final

from contin.machine import environment

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

USES_IT: Final = "scipy.sparse"  # where this is there, scipy.linalg comes soon, with a BLAS of its own


class OneThread(ContextDecorator):
    """While it is entered, BLAS computes with one thread; entering it again inside changes nothing."""

    def __init__(self) -> None:
        self._depth, self._lock, self._limits = 0, Lock(), ExitStack()
        self._libraries: tuple[int, ThreadpoolController] | None = None

    def __enter__(self) -> OneThread:
        with self._lock:
            self._depth += 1
            if self._depth == 1 and not chosen():
                if USES_IT in sys.modules:
                    import scipy.linalg  # noqa: F401 - before its threads are counted
                self._limits.enter_context(self._found().limit(limits=1, user_api="blas"))
        return self

    def _found(self) -> ThreadpoolController:
        """The libraries that are loaded, looked for (which takes some ms) only where something was imported since."""
        from threadpoolctl import ThreadpoolController

        imported = len(sys.modules)
        if self._libraries is None or self._libraries[0] != imported:
            self._libraries = imported, ThreadpoolController()
        return self._libraries[1]

    def __exit__(self, *raised: object) -> None:
        with self._lock:
            self._depth -= 1
            if self._depth == 0:
                self._limits.close()


def chosen() -> bool:
    """Whether the number of threads is somebody's choice."""
    return environment.fixed() or any(name in os.environ for name in environment.THREADS)


one_thread: Final = OneThread()
