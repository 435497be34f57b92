"""Processes that make kernels: names come in, a line each; machine code goes out, length first."""

from __future__ import annotations

import gc
import os
import struct
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from importlib import import_module
from typing import Final

from contin.kernels import mode, sources
from contin.kernels.building.functions import REGISTRY, NumbaCompiler
from contin.kernels.building.targets import EVERY, BuildTarget
from contin.machine import objects

SELDOM: Final = 500_000
"""New objects after which garbage is looked for: numba makes millions, and nearly all live until a kernel is done."""


def main() -> None:
    """Serve until there are no more names.

    Arguments: the folder that holds contin; descriptors to read and write, `3:6,4:7`, one pair for this process and
    each of its copies, or `standard`; the targets' names.
    """
    targets = [EVERY[label] for label in sys.argv[3:]]
    mode.compiler = NumbaCompiler()
    gc.set_threshold(SELDOM)
    if sys.argv[2] == "standard":
        pairs = [(0, os.dup(1))]
        os.dup2(2, 1)  # nothing that is printed may come between
    else:
        pairs = [
            (int(names), int(results))
            for names, _, results in (p.partition(":") for p in sys.argv[2].split(","))
        ]
    if len(pairs) > 1:
        warm_up()
    serve(*mine(pairs), targets)
    for _ in pairs[1:]:
        with suppress(ChildProcessError):  # a copy has none
            os.wait()
    os._exit(0)  # nothing is left to do, and taking numba down takes time


def mine(pairs: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """This process's pair, after it has made a copy of itself for every other one."""
    chosen = next((pair for pair in pairs[1:] if os.fork() == 0), pairs[0])
    for pair in pairs:
        if pair is not chosen:  # else the end of one process would not be seen while others live
            for end in pair:
                os.close(end)
    return chosen


def warm_up() -> None:
    """Let numba load what every kernel needs."""
    from contin.kernels.building import warming
    from contin.kernels.building.emit import translate

    translate(REGISTRY[warming.NAME])


def serve(names: int, results: int, targets: Sequence[BuildTarget]) -> None:
    """Make what is asked for, one after the other."""
    with os.fdopen(names) as wanted, os.fdopen(results, "wb") as out:
        for line in wanted:
            for machine_code in made(line.strip(), targets):
                data = objects.to_bytes(machine_code)
                out.write(struct.pack("<Q", len(data)) + data)
            out.flush()


def made(name: str, targets: Sequence[BuildTarget]) -> Iterator[objects.MachineCode]:
    """Machine code of a kernel for every target, under the key of its text."""
    from contin.kernels.building.emit import emit, translation

    module = name.rpartition(".")[0]
    for needed in sorted(sources.behind(module)):
        import_module(sources.BASE + needed)
    translated = translation(name)
    for target in targets:
        emitted = emit(translated, target)
        yield objects.MachineCode(name, sources.text_key(module), emitted.needs, emitted.code)
