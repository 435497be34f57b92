"""Memory that is freed: kept in the process while a branch is computed, given back to the system at its end.

A family of orbits makes arrays of a megabyte, one after the other. The GNU C library returns free memory at the end of
its heap beyond twice the largest block that it was ever given back, and every page that is asked for again is cleared
by the system first: 1,800 pages in a family of 300 planar orbits, a fifth of its time. Hence `keep_freed`.

What lives long and was made between such arrays holds the heap open, and memory that is free below it stays with the
process: 150 MB after one family of orbits, 500 MB after 300 runs in one process. Hence `give_back`.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Final

import numpy as np

with suppress(ImportError):  # Windows has none, nor the library whose memory is given back
    import resource

LARGE: Final = 2**21  # numbers: 16 MB, the largest block but one that counts
WORTH_IT: Final = 64 * 2**20  # bytes that a process grows by before free memory is looked for: that takes milliseconds

_least: int | None = None  # resident bytes when memory was given back last, or fewer that were seen since


def keep_freed() -> None:
    """From now on. The block is never written to, so no page of it is ever there; other C libraries take no notice."""
    global _least
    np.empty(LARGE)
    _least = resident()


def give_back() -> None:
    """Free memory goes back to the system where the process has grown by `WORTH_IT` since it last did.

    With the GNU C library on Linux; elsewhere nothing happens.
    """
    global _least
    trim = _trimming()
    if trim is None or (_least is not None and _peak() <= _least + WORTH_IT):
        return
    size = resident()
    if size is None:
        return
    if _least is None or size < _least:
        _least = size
    elif size > _least + WORTH_IT:
        trim(0)
        _least = resident()


def _peak() -> int:
    """Bytes that were ever in memory: told at once, where what is there now is read from a file."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def resident() -> int | None:
    """Bytes of this process that are in memory; None where the system does not say."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):  # another system, or a folder that is closed to us
        return None


@cache
def _trimming() -> Callable[[int], int] | None:
    if sys.platform != "linux":
        return None
    return getattr(ctypes.CDLL(None), "malloc_trim", None)
