"""Processes that make kernels: each takes the next one that is left, the longest first."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, NoReturn

from contin.errors import ContinError
from contin.kernels.callees import text_length
from contin.kernels.mode import Declaration
from contin.machine import objects, progress, target
from contin.machine.objects import MachineCode

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

PATIENCE: Final = 10.0  # seconds in which a process ends that has nothing more to do

MachineCodes = tuple[MachineCode, ...]
"""Machine code of one kernel, for one target or several."""


class KernelError(ContinError):
    """Machine code could neither be found nor made."""


def make(
    wanted: Sequence[Declaration], keep: Callable[[MachineCodes], object] = lambda _: None, labels: Sequence[str] = ()
) -> list[MachineCodes]:
    """Machine code of these kernels, each for this process's target or for `labels`; `keep` is told of each at once."""
    if not wanted:
        return []
    if find_spec("numba") is None:
        raise KernelError(
            f"this installation of contin has no machine code for {target.label()}, and numba, which makes it, is not "
            "installed: pip install numba"
        )
    left = deque(sorted(wanted, key=text_length, reverse=True))
    done: list[MachineCodes] = []
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
                machine_codes = worker.make(declaration.name)
                with lock:
                    done.append(machine_codes)
                    keep(machine_codes)
                    progress.tell(len(done), total, declaration.name)
        except KernelError as error:
            failed.append(str(error))

    workers = started(labels or (target.label(),), min(_processors(), total))
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
        for process in {worker.process for worker in workers}:
            process.end(at_once=len(done) < total)
    if failed:
        raise KernelError(failed[0])
    return done


def started(labels: Sequence[str], count: int) -> list[Worker]:
    """Processes that make kernels for these targets.

    Where a process can be copied, numba is imported and warmed up in one, of which the others are copies.
    """
    if not hasattr(os, "fork"):
        return [Worker(process := Process(labels), process.stdin, process.stdout) for _ in range(count)]
    pipes = [(os.pipe(), os.pipe()) for _ in range(count)]
    theirs = [(names[0], results[1]) for names, results in pipes]
    process = Process(labels, theirs)
    for pair in theirs:
        for end in pair:
            os.close(end)
    return [
        Worker(process, os.fdopen(names[1], "wb"), os.fdopen(results[0], "rb")) for names, results in pipes
    ]


class Process:
    """A process with numba in it, and its copies: one for each pair of pipes, or one on its standard streams."""

    def __init__(self, labels: Sequence[str], pipes: Sequence[tuple[int, int]] = ()) -> None:
        root = str(Path(__file__).parents[2])
        pairs = ",".join(f"{names}:{results}" for names, results in pipes) or "standard"
        # -P: no file in the folder where the user happens to be is taken for a module
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", START, root, pairs, *labels],
            stdin=subprocess.DEVNULL if pipes else subprocess.PIPE, stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL if pipes else subprocess.PIPE, env={**os.environ, **ENVIRONMENT},
            pass_fds=[end for pair in pipes for end in pair], start_new_session=bool(pipes),
        )  # fmt: skip
        self.labels = labels
        self.stdin, self.stdout = self._process.stdin, self._process.stdout
        self._errors = bytearray()
        self._reader = threading.Thread(target=self._read_errors, daemon=True)
        self._reader.start()

    def told(self) -> str:
        """The end of what it wrote to standard error."""
        self._reader.join(1.0)
        return " / ".join(bytes(self._errors).decode(errors="replace").strip().splitlines()[-3:])

    def end(self, at_once: bool) -> None:
        """See it end, with its copies, once their pipes are closed; `at_once` where they are still at work."""
        if not at_once:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(PATIENCE)
                return
        if self.stdin is None:
            with suppress(OSError):  # all of them have ended
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.wait()

    def _read_errors(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._errors += line
            del self._errors[:-20_000]


class Worker:
    """What makes one kernel after another. Names go in by lines, files of `contin.machine.objects` come out, length
    first.
    """

    def __init__(self, process: Process, names: Any, results: Any) -> None:
        self.process, self.names, self.results = process, names, results

    def make(self, name: str) -> MachineCodes:
        """The machine code of one kernel for every target."""
        try:
            self.names.write(name.encode() + b"\n")
            self.names.flush()
        except OSError:
            self._fail(name)
        return tuple(self._read() or self._fail(name) for _ in self.process.labels)

    def _read(self) -> MachineCode | None:
        length = self.results.read(8)
        if len(length) < 8:
            return None
        return objects.from_bytes(self.results.read(struct.unpack("<Q", length)[0]))

    def _fail(self, name: str) -> NoReturn:
        raise KernelError(f"the kernel {name} could not be compiled: {self.process.told() or 'no reason given'}")

    def close(self) -> None:
        """There are no more names."""
        with suppress(OSError):
            self.names.close()


def _processors() -> int:
    try:
        return max(len(os.sched_getaffinity(0)), 1)
    except AttributeError:
        return os.cpu_count() or 1
