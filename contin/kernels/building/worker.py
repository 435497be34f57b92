"""A process that makes kernels: names on standard input, a line each; machine code on standard output, length first."""

from __future__ import annotations

import os
import struct
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module

from contin.kernels import mode, sources
from contin.kernels.building.functions import REGISTRY, NumbaCompiler
from contin.kernels.building.targets import EVERY, BuildTarget
from contin.machine import objects


def main() -> None:
    """Serve until standard input ends. Arguments: the folder that holds contin, the targets' names."""
    targets = [EVERY[label] for label in sys.argv[2:]]
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing that is printed may come between
    mode.compiler = NumbaCompiler()
    for line in sys.stdin:
        for piece in made(line.strip(), targets):
            data = objects.to_bytes(piece)
            out.write(struct.pack("<Q", len(data)) + data)
        out.flush()


def made(name: str, targets: Sequence[BuildTarget]) -> Iterator[objects.Piece]:
    """Machine code of a kernel for every target, under the key of its text."""
    from contin.kernels.building.emit import emit, translate

    module = name.rpartition(".")[0]
    for needed in sorted(sources.behind(module)):
        import_module(sources.BASE + needed)
    translated = translate(REGISTRY[name])
    for target in targets:
        emitted = emit(translated, target)
        yield objects.Piece(name, sources.text_key(module), emitted.needs, emitted.code)
