"""The command in a process of its own that can be killed: forked, so that it has the kernels and imports at hand."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from contin.cli.main import main
from contin.problems.equilibria.equilibrium import EquilibriumProblem

needs_fork = pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods() or not hasattr(signal, "SIGHUP"), reason="needs fork"
)


SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


def _child(folder: Path, arguments: list[str], before: Callable[[], None] | None, out: Any, encoding: str) -> None:
    for name in SIGNALS:  # `nohup pytest` ignores SIGHUP, a shell's background job SIGINT, and children inherit that
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    os.chdir(folder)
    for number in (signal.SIGHUP, signal.SIGTERM):  # under `nohup` a hang-up is ignored, and children inherit that
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    errors = os.open("err", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(errors, 2)
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - for the life of the process
    if out is None:
        os.close(1)
        sys.stdout = None
    else:
        os.dup2(out, 1)
        sys.stdout = open(1, "w", encoding=encoding, closefd=False)  # noqa: SIM115
    if before is not None:
        before()
    main(arguments)


def started(
    folder: Path, *arguments: Any, before: Callable[[], None] | None = None, out: int | None = -1,
    encoding: str = "utf-8",
) -> Any:  # fmt: skip
    """The process of `contin ARGUMENTS`; standard error goes to the file `err`, standard output to a descriptor.

    out : None for a closed one, -1 for the file `out`.
    """
    opened = os.open(folder / "out", os.O_WRONLY | os.O_CREAT | os.O_TRUNC) if out == -1 else out
    arguments_ = [str(argument) for argument in arguments]
    process = multiprocessing.get_context("fork").Process(
        target=_child, args=(folder, arguments_, before, opened, encoding), daemon=True
    )  # daemon: it does not live on when a test fails before it ended the process
    process.start()
    if out == -1:
        os.close(opened)
    return process


def finished(process: Any, seconds: float = 300.0) -> int:
    """The exit code of a process; minus the signal that killed it. One that hangs is killed."""
    process.join(seconds)
    hangs = process.exitcode is None
    if hangs:
        process.kill()
        process.join()
    assert not hangs, "the process hangs"
    return int(process.exitcode)


def short_chunks(rows: int = 20) -> None:
    """`before` of a branch of equilibria without end: it is kept as often as ever, by rows instead of thousands."""
    EquilibriumProblem.maximum_chunk = rows  # type: ignore[assignment]


def wait_for(condition: Callable[[], bool], process: Any, seconds: float = 120.0) -> bool:
    """True once the condition holds; False where the process ends before."""
    deadline = time.monotonic() + seconds
    while not condition():
        if not process.is_alive():
            return condition()
        assert time.monotonic() < deadline
        time.sleep(0.005)
    return True


def kept(path: Path) -> int:
    """How much of a run is on the disk, without opening it: another reader would be in the way of its lock."""
    log = Path(f"{path}-wal")
    return log.stat().st_size if log.exists() else 0
