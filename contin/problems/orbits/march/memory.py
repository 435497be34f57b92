"""The kernels' memory, kept from one call to the next: asking for it anew is a part of a step of a large system."""

from __future__ import annotations

import threading
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_march import new_memory

KEPT: Final = 4  # shapes: probes, parts of a chunk and finer meshes follow each other

_known = threading.local()


def memory_of(n: int, m: int, nontrivial: int, intervals: int, size: int, p: Array) -> tuple[Any, Any, Any]:
    """(points, factors, scratch) of `contin.kernels.collocation_march.new_memory`, to be used up to the next call.

    One thread's memory is that of an earlier call where the shapes are those of one of the last `KEPT`.
    """
    shape, held = (n, m, nontrivial, intervals, size, p.size), getattr(_known, "held", None)
    if held is None:
        held = _known.held = {}
    memory = held.pop(shape, None)
    if memory is None:
        memory = new_memory(n, m, nontrivial, intervals, size, p)  # type: ignore[no-untyped-call]
        if len(held) >= KEPT:
            del held[next(iter(held))]  # that of the call longest ago
    held[shape] = memory
    points, factors, scratch = memory
    points.p[:] = p
    scratch.basis[:] = np.nan  # nothing is known of the multipliers of another orbit
    return points, factors, scratch
