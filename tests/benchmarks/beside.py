"""The same model in AUTO-07p, and both programs timed in turn.

Times are processor times of computing (no import, no compilation) and medians of several runs; AUTO's is its whole
process, whose start takes 1-2 ms. The Fortran is written from the contin model, so that both programs solve the same
equations. Without AUTO-07p (Debian packages auto-07p and gfortran; set AUTO_DIR) only contin's times are printed.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contin.model.model import Model
from contin.model.printing import to_text

AUTO = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p"))
RUNS = 7
CONSTANTS = {
    "IPS": 1, "IRS": 0, "ILP": 1, "ISP": 1, "ISW": 1, "ICP": [1], "IPLT": 0, "NBC": 0, "NINT": 0, "IAD": 3, "NTST": 50,
    "NCOL": 4, "NPR": 0, "MXBF": 0, "IID": 0, "ITMX": 9, "ITNW": 7, "NWTN": 3, "JAC": 0, "EPSL": 1e-7, "EPSU": 1e-7,
    "EPSS": 1e-5, "IADS": 1, "NPAR": 36, "DSMIN": 1e-6,
}  # fmt: skip
TYPES = {"BP": (1, 6), "LP": (2, 5), "HB": (3,), "PD": (7,), "TR": (8,), "EP": (9,)}  # in AUTO's output, modulo 10
_NUMBER = re.compile(r"(\^?)(?<![\w.])(\d+(?:\.\d*)?)(?:[eE]([-+]?\d+))?")


def fortran(model: Model, start: Any = None, parameters: Any = None) -> str:
    """AUTO's equations file: u(k) is the k-th state, par(k) the k-th parameter, with their values at a start."""
    u, p = model.start_point(start, parameters)
    places = {name: f"u({k + 1})" for k, name in enumerate(model.state_names)}
    places |= {name: f"par({k + 1})" for k, name in enumerate(model.parameter_names)}
    formulas = [f"f({k + 1}) = {formula(to_text(value), places)}" for k, value in enumerate(model.equations)]
    values = [f"par({k + 1}) = {float(x)!r}d0" for k, x in enumerate(p)]
    values += [f"u({k + 1}) = {float(x)!r}d0" for k, x in enumerate(u)]
    body = [
        "subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)",
        "implicit none",
        "integer, intent(in) :: ndim, icp(*), ijac",
        "double precision, intent(in) :: u(ndim), par(*)",
        "double precision, intent(out) :: f(ndim)",
        "double precision, intent(inout) :: dfdu(ndim, *), dfdp(ndim, *)",
        "double precision, parameter :: pi = 3.141592653589793d0",
        *formulas,
        "end subroutine",
        "subroutine stpnt(ndim, u, par, t)",
        "implicit none",
        "integer, intent(in) :: ndim",
        "double precision, intent(inout) :: u(ndim), par(*)",
        "double precision, intent(in) :: t",
        *(re.sub(r"e([-+]?\d+)d0", r"d\1", value) for value in values),
        "end subroutine",
    ]
    for name in ("bcnd", "icnd", "fopt", "pvls"):
        body += [f"subroutine {name}", "end subroutine"]
    return "\n".join(continued(line) for line in body) + "\n"


def formula(text: str, places: Mapping[str, str]) -> str:
    """A formula in Fortran: numbers in double precision, whole exponents as such, names as elements of u and par."""

    def literal(match: re.Match[str]) -> str:
        power, digits, exponent = match.groups()
        return f"^{digits}" if power and exponent is None and "." not in digits else f"{power}{digits}d{exponent or 0}"

    numbers = _NUMBER.sub(literal, text).replace("^", "**")
    return re.sub(r"(?<![\w.])[A-Za-z_]\w*", lambda name: places.get(name[0], name[0]), numbers)


def continued(line: str) -> str:
    return "&\n&".join(line[k : k + 100] for k in range(0, len(line), 100))


@dataclass(frozen=True)
class Auto:
    """AUTO compiled for one model, in a folder of its own."""

    folder: Path

    @classmethod
    def of(cls, model: Model, start: Any = None, parameters: Any = None) -> Auto | None:
        """None where AUTO is not installed."""
        if not (AUTO / "lib").is_dir() or shutil.which("gfortran") is None:
            return None
        folder = Path(tempfile.mkdtemp())
        (folder / "model.f90").write_text(fortran(model, start, parameters))
        objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
        command = ["gfortran", "-O2", "-fopenmp", "model.f90", "-o", "model", *objects]
        subprocess.run(command, check=True, cwd=folder)
        return cls(folder)

    def run(self, **constants: Any) -> tuple[float, int]:
        """Processor time of one run, and its steps."""
        (self.folder / "fort.2").write_text(as_constants(CONSTANTS | constants))
        for number in (7, 8, 9):
            (self.folder / f"fort.{number}").unlink(missing_ok=True)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.folder / "model"], cwd=self.folder, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return seconds, len(self._rows())

    def from_point(self, type_: str, last: bool = False, **constants: Any) -> int:
        """Run, and keep what was found for restarts from the first (or last) point of a type: its label, for IRS."""
        self.run(**constants)
        labels = [row[3] for row in self._rows() if abs(int(row[2])) % 10 in TYPES[type_]]
        shutil.copy(self.folder / "fort.8", self.folder / "fort.3")
        return int(labels[-1 if last else 0])

    def _rows(self) -> list[list[str]]:
        rows = [text.split() for text in (self.folder / "fort.7").read_text().splitlines()]
        return [row for row in rows if row[0] != "0"]


def as_constants(constants: Mapping[str, Any]) -> str:
    """AUTO's file of constants."""
    return "".join(f"{name}={_value(value)}\n" for name, value in constants.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {v}" for k, v in value.items()) + "}"
    return str(value)


def timed(work: Callable[[], object]) -> float:
    """Processor time."""
    began = time.process_time()
    work()
    return time.process_time() - began


def compare(
    title: str, steps: int, work: Callable[[], object], auto: Callable[[], tuple[float, int]] | None, runs: int = RUNS
) -> None:
    """Print both medians a step and their ratio, the two programs in turn, on one core."""
    ours, theirs = in_turn(work, auto, runs)
    report(title, statistics.median(ours) / steps, [seconds / count for seconds, count in theirs], f"{steps} steps")


def compare_steps(
    title: str, work: Callable[[int], Any], auto: Callable[[int], tuple[float, int]] | None, finer: int = 4,
    runs: int = RUNS
) -> None:  # fmt: skip
    """What one more step costs: both programs with steps a `finer`-th as long, less what they take as they are.

    Starts and labels, which cost the same whatever the steps, drop out. work, auto : with steps a k-th as long.
    """
    coarse = in_turn(lambda: work(1), auto and (lambda: auto(1)), runs)
    fine = in_turn(lambda: work(finer), auto and (lambda: auto(finer)), runs)
    steps = work(finer).steps - work(1).steps
    mine = (statistics.median(fine[0]) - statistics.median(coarse[0])) / steps
    pairs = zip(*(sorted(theirs) for _, theirs in (fine, coarse)), strict=True)
    report(title, mine, [(a - b) / (m - n) for (a, m), (b, n) in pairs], "one more step")


def in_turn(
    work: Callable[[], object], auto: Callable[[], tuple[float, int]] | None, runs: int
) -> tuple[list[float], list[tuple[float, int]]]:
    """Processor times of contin; those of AUTO, and its steps."""
    ours, theirs = [], []
    work()  # its kernels are there now, and no other process need be started
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    for _ in range(runs):
        work()  # after a wait for the other program, virtual machines give memory back page by page, in our time
        ours.append(timed(work))
        if auto is not None:
            theirs.append(auto())
    return ours, theirs


def report(title: str, mine: float, theirs: list[float], of: str) -> None:
    """A line; AUTO's time is the median."""
    line = f"{title:44s} contin {mine * 1e6:9.2f} us a step ({of})"
    if theirs:
        other = statistics.median(theirs)
        line += f"   AUTO {other * 1e6:9.2f} us   ratio {mine / other:5.2f}"
    print(line, flush=True)
