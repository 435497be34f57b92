"""contin beside AUTO-07p on curves in two parameters, by hand: `python tests/benchmarks/loci.py`.

AUTO's demo ab: the curves of folds and Hopf points through the first such point of the branch, both programs in steps
so short that the step control plays no part, with all detection on. Times are processor times of computing a step,
medians of several runs, the programs in turn. The folds are asserted in closed form first.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable
from math import exp
from pathlib import Path

from equilibria import AUTO, CONSTANTS, HERE, RUNS, timed

from contin.api import continuation, equilibrium
from contin.model.model import Model

LINE = "NDIM=2\nNMX=400\nDS=1e-2\nDSMAX=5e-2\nRL1=0.5\n"
CURVE = "NDIM=2\nNMX=1000\nDS=1e-3\nDSMIN=1e-6\nDSMAX=5e-3\n"


def auto_curve(kind: int) -> Callable[[], tuple[float, int]] | None:
    """A function that runs AUTO once along the curve of the first point of this type (2 fold, 3 Hopf)."""
    if not (AUTO / "lib").is_dir() or shutil.which("gfortran") is None:
        return None
    folder = Path(tempfile.mkdtemp())
    objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
    command = ["gfortran", "-O2", "-fopenmp", str(HERE / "auto" / "ab.f90"), "-o", str(folder / "ab"), *objects]
    subprocess.run(command, check=True, cwd=folder)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}

    def run(constants: str) -> float:
        (folder / "fort.2").write_text(constants)
        for number in (7, 8, 9):
            (folder / f"fort.{number}").unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([folder / "ab"], cwd=folder, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def rows() -> list[list[str]]:
        return [text.split() for text in (folder / "fort.7").read_text().splitlines()]

    run(CONSTANTS + LINE)
    label = next(row[3] for row in rows() if row[0] != "0" and row[2] == str(kind))
    shutil.copy(folder / "fort.8", folder / "fort.3")
    constants = CONSTANTS.replace("IRS=0", f"IRS={label}").replace("ISW=1", "ISW=2").replace("ICP=[1]", "ICP=[1,3]")

    def curve_run() -> tuple[float, int]:
        seconds = run(constants + CURVE)
        return seconds, sum(row[0] != "0" for row in rows())

    return curve_run


def reactor() -> Model:
    """AUTO's demo ab."""
    return Model(
        "ab", states={"u1": 0, "u2": 0}, parameters={"p1": 0, "p2": 14, "p3": 2},
        equations={"u1": "-u1 + p1*(1 - u1)*exp(u2)", "u2": "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"},
    )  # fmt: skip


def compare(title: str, label: str, kind: int) -> None:
    """Print the medians a step and their ratio."""
    point = continuation(equilibrium(reactor()), "p1", (0, 0.5))[label]
    bounds = {"p1": (0, 0.5), "p3": (0, 3)}
    settings = {"steps": 1000, "step": 5e-4, "max_step": 5e-4}

    def work() -> object:
        return continuation(point.locus(), ["p1", "p3"], bounds, settings=settings)

    curve = continuation(point.locus(), ["p1", "p3"], bounds, settings=settings)
    if label == "LP1":  # u2 = 14 u1 / (1 + p3), p1 = u1 exp(-u2) / (1 - u1), and u1 (1 - u1) = (1 + p3) / 14
        u = curve.columns["u1"]
        p3 = 14 * u * (1 - u) - 1
        p1 = [a / (1 - a) * exp(-14 * a / (1 + b)) for a, b in zip(u, p3, strict=True)]
        assert max(abs(p3 - curve.columns["p3"])) < 1e-8
        assert max(abs(p1 - curve.columns["p1"])) < 1e-8
    auto = auto_curve(kind)
    ours, theirs = [], []
    for _ in range(RUNS):
        ours.append(timed(work) / curve.steps)
        if auto is not None:
            seconds, count = auto()
            theirs.append(seconds / count)
    mine = statistics.median(ours) * 1e6
    line = f"{title:24s} contin {mine:7.2f} us a step ({curve.steps} steps)"
    if theirs:
        other = statistics.median(theirs) * 1e6
        line += f"   AUTO {other:7.2f} us   ratio {mine / other:5.2f}"
    print(line)


if __name__ == "__main__":
    compare("fold curve, n = 2", "LP1", 2)
    compare("Hopf curve, n = 2", "HB1", 3)
