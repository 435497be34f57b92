"""The kernels' memory, kept from one call to the next: asking for it anew is a part of a step of a large system."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_march import new_memory

_last = threading.local()


def memory_of(n: int, m: int, nontrivial: int, intervals: int, size: int, p: Array) -> tuple[Any, Any, Any]:
    """(points, factors, scratch) of `contin.kernels.collocation_march.new_memory`, to be used up to the next call.

    One thread's memory is that of its last call where the shapes are the same.
    """
    shape = (n, m, nontrivial, intervals, size, p.size)
    if getattr(_last, "shape", None) != shape:
        _last.held = new_memory(n, m, nontrivial, intervals, size, p)  # type: ignore[no-untyped-call]
        _last.shape = shape
    points, factors, scratch = _last.held
    points.p[:] = p
    scratch.basis[:] = np.nan  # nothing is known of the multipliers of another orbit
    return points, factors, scratch
