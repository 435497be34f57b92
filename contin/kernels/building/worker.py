"""A process that makes kernels: names on standard input, a line each; machine code on standard output, length first."""

from __future__ import annotations

import os
import struct
import sys
from importlib import import_module

from contin.kernels import mode, sources
from contin.kernels.building.functions import REGISTRY, NumbaCompiler
from contin.kernels.building.targets import EVERY, BuildTarget
from contin.machine import objects


def main() -> None:
    """Serve until standard input ends. Arguments: the folder that holds contin, the target's name."""
    target = EVERY[sys.argv[2]]
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing that is printed may come between
    mode.compiler = NumbaCompiler()
    for line in sys.stdin:
        data = objects.to_bytes(made(line.strip(), target))
        out.write(struct.pack("<Q", len(data)) + data)
        out.flush()


def made(name: str, target: BuildTarget) -> objects.Piece:
    """Machine code of a kernel, under the key that the cache has for it."""
    from contin.kernels.building.emit import emit, translate

    module = name.rpartition(".")[0]
    for needed in sorted(sources.behind(module)):
        import_module(sources.BASE + needed)
    emitted = emit(translate(REGISTRY[name]), target)
    return objects.Piece(name, sources.text_key(module), emitted.needs, emitted.code)
