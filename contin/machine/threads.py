"""Long loops shared among threads, where every part of them is computed for itself: the digits are those of one thread.

Parts are taken one after the other by whoever is free, so that a processor that is busy with something else delays no
more than its part.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from multiprocessing import parent_process
from typing import Final

from contin.machine import environment

PART: Final = 1 << 15  # numbers: some 0.1 ms, many times what it takes to wake a thread
MOST: Final = 8  # threads: beyond, memory has no more to give

Work = Callable[[int, int], object]

_pools: dict[int, ThreadPoolExecutor] = {}  # by process: threads do not live on in its copies


def in_parts(first: int, last: int, work: Work) -> None:
    """work(a, b) for parts [a, b) of [first, last), the same ones whatever the threads, on several where it is long."""
    parts = -(-(last - first) // PART)
    helpers = min(threads(), parts // 2) - 1
    left = count()
    if helpers < 1:
        _take(left, parts, first, last, work)
        return
    pool = _pool()
    futures = [pool.submit(_take, left, parts, first, last, work) for _ in range(helpers)]
    try:
        _take(left, parts, first, last, work)
    finally:
        for future in futures:
            if not future.cancel():
                future.result()


def _take(left: Iterator[int], parts: int, first: int, last: int, work: Work) -> None:
    while (k := next(left)) < parts:
        a = first + k * PART
        work(a, min(a + PART, last))


def threads() -> int:
    """As many as there are processors, or as `OMP_NUM_THREADS` says; one in a process that another one has started."""
    if parent_process() is not None:
        return 1
    asked = environment.asked()
    if asked is not None:
        return min(asked, MOST)
    try:
        return min(len(os.sched_getaffinity(0)), MOST)
    except AttributeError:
        return min(os.cpu_count() or 1, MOST)


def _pool() -> ThreadPoolExecutor:
    here = os.getpid()
    if here not in _pools:
        _pools[here] = ThreadPoolExecutor(MOST - 1, thread_name_prefix="contin")
    return _pools[here]
