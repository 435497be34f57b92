"""Processes that make kernels: each takes the next one that is left, the longest first."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NoReturn

from contin.errors import ContinError
from contin.kernels.mode import Declaration
from contin.machine import objects, progress, target
from contin.machine.objects import Piece

ENVIRONMENT: Final = {
    "NUMBA_CPU_NAME": "generic",  # nothing that this machine has may show in the code
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "3",
    "NUMBA_DISABLE_JIT": "0",
    "PYTHONHASHSEED": "0",
    "OPENBLAS_CORETYPE": "Prescott",  # constants that numpy computes while the kernels are imported
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "NPY_DISABLE_CPU_FEATURES": "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR",
}
START: Final = "import sys; sys.path.insert(0, sys.argv[1]); from contin.kernels.building.worker import main; main()"


Pieces = tuple[Piece, ...]
"""Machine code of one kernel, for one target or several."""


class KernelError(ContinError):
    """Machine code could neither be found nor made."""


def make(
    wanted: Sequence[Declaration], keep: Callable[[Pieces], object] = lambda _: None, labels: Sequence[str] = ()
) -> list[Pieces]:
    """Machine code of these kernels, each for this process's target or for `labels`; `keep` is told of each at once."""
    if not wanted:
        return []
    if find_spec("numba") is None:
        raise KernelError(
            f"this installation of contin has no machine code for {target.label()}, and numba, which makes it, is not "
            "installed: pip install numba"
        )
    left = deque(sorted(wanted, key=_length, reverse=True))
    done: list[Pieces] = []
    failed: list[str] = []
    lock = threading.Lock()
    total = len(left)
    progress.tell(0, total)

    def serve(worker: Worker) -> None:
        try:
            while not failed:
                with lock:
                    if not left:
                        return
                    declaration = left.popleft()
                pieces = worker.make(declaration.name)
                with lock:
                    done.append(pieces)
                    keep(pieces)
                    progress.tell(len(done), total, declaration.name)
        except KernelError as error:
            failed.append(str(error))

    workers = [Worker(labels or (target.label(),)) for _ in range(min(_processors(), total))]
    try:
        threads = [threading.Thread(target=serve, args=(worker,), daemon=True) for worker in workers]
        for thread in threads:
            thread.start()
        for thread in threads:
            while thread.is_alive():  # in turns, so that Ctrl-C is heard
                thread.join(0.2)
    finally:
        for worker in workers:
            worker.close()
    if failed:
        raise KernelError(failed[0])
    return done


class Worker:
    """A process with numba in it. Names go in by lines, files of `contin.machine.objects` come out, length first."""

    def __init__(self, labels: Sequence[str]) -> None:
        self.labels = labels
        root = str(Path(__file__).parents[2])
        # -P: no file in the folder where the user happens to be is taken for a module
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", START, root, *labels],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **ENVIRONMENT},
        )  # fmt: skip
        self._errors = bytearray()
        self._reader = threading.Thread(target=self._read_errors, daemon=True)
        self._reader.start()

    def make(self, name: str) -> Pieces:
        """The machine code of one kernel for every target."""
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(name.encode() + b"\n")
            self.process.stdin.flush()
        except OSError:
            self._fail(name)
        return tuple(self._read() or self._fail(name) for _ in self.labels)

    def _read(self) -> Piece | None:
        assert self.process.stdout is not None
        length = self.process.stdout.read(8)
        if len(length) < 8:
            return None
        return objects.from_bytes(self.process.stdout.read(struct.unpack("<Q", length)[0]))

    def _fail(self, name: str) -> NoReturn:
        self._reader.join(5.0)
        told = bytes(self._errors).decode(errors="replace").strip().splitlines()
        raise KernelError(f"the kernel {name} could not be compiled: {' / '.join(told[-3:]) or 'no reason given'}")

    def close(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()

    def _read_errors(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self._errors += line
            del self._errors[:-20_000]


def _processors() -> int:
    try:
        return max(len(os.sched_getaffinity(0)), 1)
    except AttributeError:
        return os.cpu_count() or 1


def _length(declaration: Declaration) -> int:
    """A measure of the time it takes: the bytes of Python's own code, parts included."""
    from contin.kernels.library import text_length

    return text_length(declaration)
