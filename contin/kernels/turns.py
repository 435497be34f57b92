"""Processes that need the same kernel on a fresh cache: one compiles it, the others wait and load what it has written.

Parallel workers, tests and runs started side by side would otherwise each spend the same minutes. Every kernel has a
byte of one file, which whoever compiles the kernel locks; the system frees it when the process ends, however it ends.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from numba.core import event

try:
    import fcntl
except ImportError:  # Windows: each process compiles for itself
    fcntl = None  # type: ignore[assignment]

WAITING = "contin:waiting"  # numba event: another process compiles this kernel now


@cache
def _file(folder: str) -> int | None:
    """Descriptor of the file of locks, open to the end of the process: to close it would free them all."""
    try:
        return os.open(Path(folder) / "turns", os.O_RDWR | os.O_CREAT, 0o600)
    except OSError:
        return None


@contextmanager
def turn(folder: str, name: str, dispatcher: object) -> Iterator[None]:
    """Wait until no other process compiles kernel `name` into `folder`; none does while the block runs.

    Kernels wait for those they call and never for those that call them, so no two processes wait for each other. The
    caller holds numba's compiler lock: such locks do not tell the threads of a process apart. On a file system without
    locks nobody waits.
    """
    file = None if fcntl is None else _file(folder)
    place = zlib.crc32(name.encode())
    if file is None or not _lock(file, place, dispatcher):
        yield
        return
    try:
        yield
    finally:
        fcntl.lockf(file, fcntl.LOCK_UN, 1, place)


def _lock(file: int, place: int, dispatcher: object) -> bool:
    """Whether the lock of a place could be had, at once or after a wait."""
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)
    except (BlockingIOError, PermissionError):  # EAGAIN or EACCES: someone has it
        try:
            with event.trigger_event(WAITING, {"dispatcher": dispatcher}):
                fcntl.lockf(file, fcntl.LOCK_EX, 1, place)
        except OSError:
            return False
    except OSError:
        return False
    return True
