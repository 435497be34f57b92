"""contin beside AUTO-07p on equilibria, by hand: `python tests/benchmarks/equilibria.py`.

Times are processor times of computing (no import, no compilation) and medians of several runs, the programs in turn;
AUTO's is its whole process, whose start takes 1-2 ms. Every benchmark first asserts its special points to 1e-8. Without
AUTO-07p (Debian packages auto-07p and gfortran; set AUTO_DIR) only contin's times are printed.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from contin.api import continuation, diagram, equilibrium
from contin.model.model import Model

HERE = Path(__file__).parent
AUTO = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p"))
RUNS = 7
CONSTANTS = (
    "IPS=1\nIRS=0\nILP=1\nISP=1\nISW=1\nICP=[1]\nIPLT=0\nNBC=0\nNINT=0\nIAD=3\nNTST=50\nNCOL=4\nNPR=0\nMXBF=0\nIID=0\n"
    "ITMX=9\nITNW=7\nNWTN=3\nJAC=0\nEPSL=1e-7\nEPSU=1e-7\nEPSS=1e-5\nIADS=1\nNPAR=36\n"
)


def auto_program(name: str, constants: str) -> Callable[[], float] | None:
    """A function that runs AUTO once and returns its processor time; None where AUTO is not installed."""
    if not (AUTO / "lib").is_dir() or shutil.which("gfortran") is None:
        return None
    folder = Path(tempfile.mkdtemp())
    objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
    command = ["gfortran", "-O2", "-fopenmp", str(HERE / "auto" / f"{name}.f90"), "-o", str(folder / name), *objects]
    subprocess.run(command, check=True, cwd=folder)
    (folder / "fort.2").write_text(CONSTANTS + constants)

    def run() -> float:
        for number in (7, 8, 9):
            (folder / f"fort.{number}").unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run([folder / name], cwd=folder, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    return run


def timed(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began


def compare(title: str, steps: int, work: Callable[[], object], auto: Callable[[], float] | None) -> None:
    """Print both medians and the ratio, the two programs in turn."""
    ours, theirs = [], []
    for _ in range(RUNS):
        ours.append(timed(work))
        if auto is not None:
            theirs.append(auto())
    mine = statistics.median(ours)
    line = f"{title:44s} contin {mine * 1e3:8.2f} ms ({mine / steps * 1e6:6.2f} us a step)"
    if theirs:
        other = statistics.median(theirs)
        line += f"   AUTO {other * 1e3:8.2f} ms   ratio {mine / other:5.2f}"
    print(line)


def pair_line() -> None:
    """The pair's in-phase line, mu from 10 to 0.5 in steps of 0.001, full detection."""
    start = equilibrium(pair(), "in-phase", {"mu": 10})
    settings = {"step": 0.001 / 9.5, "max_step": 0.001 / 9.5}

    def work() -> object:
        return continuation(start, "mu", (0.5, 10), direction="down", settings=settings)

    found = continuation(start, "mu", (0.5, 10), direction="down", settings=settings)
    assert abs(found["BP1"].values["mu"] - 4.75646174352128) < 1e-8  # -15 pi beta/8 + 27a^2/(64b) + ..., beta = 0.8
    auto = auto_program("pair", "NDIM=3\nNMX=9500\nDS=-0.001\nDSMIN=1e-5\nDSMAX=0.001\nUZSTOP={1: 0.5}\n")
    compare("pair, 9500 steps, n = 3", found.steps, work, auto)


def reactor() -> None:
    """AUTO's demo ab, thousands of small steps, n = 2, full detection."""
    model = Model(
        "ab",
        states={"u1": 0, "u2": 0},
        parameters={"p1": 0, "p2": 14, "p3": 2},
        equations={"u1": "-u1 + p1*(1 - u1)*exp(u2)", "u2": "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"},
    )
    start = equilibrium(model)
    settings = {"step": 2.8e-4, "max_step": 2.8e-4}  # about as many steps as AUTO takes

    def work() -> object:
        return continuation(start, "p1", (0, 2), direction="up", settings=settings)

    found = continuation(start, "p1", (0, 2), direction="up", settings=settings)
    # folds: u2 = p2 u1/(1 + p3), p1 = u1/(1 - u1) exp(-14 u1/3), dp1/du1 = 0 at u1 (1 - u1) = 3/14
    roots = [(1 - (1 - 12 / 14) ** 0.5) / 2, (1 + (1 - 12 / 14) ** 0.5) / 2]
    folds = [u / (1 - u) * 2.718281828459045 ** (-14 * u / 3) for u in roots]
    got = [p.values["p1"] for p in found.points if p.type == "LP"]
    assert all(min(abs(g - fold) for g in got) < 1e-8 for fold in folds)
    auto = auto_program("ab", "NDIM=2\nNMX=5000\nDS=1e-3\nDSMIN=1e-5\nDSMAX=2e-3\n")
    compare("ab, 5000 steps, n = 2", found.steps, work, auto)


def pair() -> Model:
    """The averaged pair in polar form, typed from the paper."""
    rest = "sqrt((3*a + sqrt(9*a^2 - 48*pi*b*beta))/(4*b))"
    return Model(
        "pair",
        states={"r1": 2, "r2": 2, "psi": {"value": 0, "period": "2*pi"}},
        parameters={"mu": 8, "beta": 0.8, "a": 4, "b": 1},
        equations={
            "r1": "(-6*pi*mu*r2*sin(psi) - 6*pi*beta*r1 + 3*a*r1^3 - 2*b*r1^5)/(12*pi)",
            "r2": "(6*pi*mu*r1*sin(psi) - 6*pi*beta*r2 + 3*a*r2^3 - 2*b*r2^5)/(12*pi)",
            "psi": "(16*mu*(r1/r2 - r2/r1)*cos(psi) + 6*a*(r1^2 - r2^2) - 5*b*(r1^4 - r2^4))/32",
        },
        symmetries={"exchange": {"r1": "r2", "r2": "r1", "psi": "-psi"}},
        starts={
            "in-phase": {"r1": rest, "r2": rest, "psi": 0},
            "anti-phase": {"r1": rest, "r2": rest, "psi": "pi"},
        },
    )


def pair_diagram() -> None:
    """The pair's whole diagram of equilibria, explored."""
    model = pair()

    def work() -> object:
        return diagram(model, "mu", (0.05, 8), start=["in-phase", "anti-phase"], orbits=False)

    found = diagram(model, "mu", (0.05, 8), start=["in-phase", "anti-phase"], orbits=False)
    fork = found["in-phase/BP1"]
    wanted = {"HB1": 4.53161898330735564, "LP1": 0.14562601707, "LP2": 0.248773957711}
    assert all(abs(fork[label].values["mu"] - value) < 1e-8 for label, value in wanted.items())
    compare("pair, whole diagram of equilibria", sum(b.steps for b in found), work, None)


if __name__ == "__main__":
    pair_line()
    reactor()
    pair_diagram()
