"""contin beside AUTO-07p on families of periodic orbits, by hand: `python tests/benchmarks/orbits.py`.

Both follow the family born at the same Hopf point on the same mesh (intervals x 4 points) with all detection on, in
steps so short that the step control plays no part. What is compared is the time a step: processor time of computing,
medians of several runs, the programs in turn. Every benchmark first asserts its Hopf point and a period in closed form.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable
from math import pi, sin, sqrt
from pathlib import Path

from equilibria import AUTO, CONSTANTS, HERE, RUNS, timed

from contin.api import continuation, equilibrium
from contin.model.model import Model


def auto_orbits(name: str, line: str, family: str) -> Callable[[], tuple[float, int]] | None:
    """A function that runs AUTO once from the Hopf point that `line` finds: (processor time, steps)."""
    if not (AUTO / "lib").is_dir() or shutil.which("gfortran") is None:
        return None
    folder = Path(tempfile.mkdtemp())
    objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
    command = ["gfortran", "-O2", "-fopenmp", str(HERE / "auto" / f"{name}.f90"), "-o", str(folder / name), *objects]
    subprocess.run(command, check=True, cwd=folder)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}

    def run(constants: str) -> float:
        (folder / "fort.2").write_text(constants)
        for number in (7, 8, 9):
            (folder / f"fort.{number}").unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([folder / name], cwd=folder, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    run(CONSTANTS + line)
    rows = [text.split() for text in (folder / "fort.7").read_text().splitlines()]
    label = next(row[3] for row in rows if row[0] != "0" and row[2] == "3")  # type 3: Hopf
    shutil.copy(folder / "fort.8", folder / "fort.3")
    orbits = CONSTANTS.replace("IPS=1", "IPS=2").replace("IRS=0", f"IRS={label}").replace("ISP=1", "ISP=2")
    orbits = orbits.replace("ICP=[1]", "ICP=[1,11]") + family

    def family_run() -> tuple[float, int]:
        seconds = run(orbits)
        return seconds, sum(row.split()[0] != "0" for row in (folder / "fort.7").read_text().splitlines())

    return family_run


def compare(
    title: str, model: Model, parameter: str, bounds: tuple[float, float], step: float, steps: int, intervals: int,
    hopf: tuple[float, float], auto: Callable[[], tuple[float, int]] | None,
) -> None:  # fmt: skip
    """Print the medians a step and their ratio; hopf: parameter and period of the Hopf point."""
    line = continuation(equilibrium(model), parameter, bounds)
    born = line["HB1"]
    assert abs(born.values[parameter] - hopf[0]) < 1e-8 * abs(hopf[0])
    settings = {"intervals": intervals, "points": 4, "steps": steps, "step": step, "max_step": step}

    def work() -> object:
        return continuation(born.switch(), parameter, bounds, settings=settings)

    family = continuation(born.switch(), parameter, bounds, settings=settings)
    assert abs(family.columns["period"][0] - hopf[1]) < 1e-8 * hopf[1]
    ours, theirs = [], []
    for _ in range(RUNS):
        ours.append(timed(work) / family.steps)
        if auto is not None:
            seconds, count = auto()
            theirs.append(seconds / count)
    mine = statistics.median(ours) * 1e3
    text = f"{title:34s} contin {mine:8.3f} ms a step"
    if theirs:
        other = statistics.median(theirs) * 1e3
        text += f"   AUTO {other:8.3f} ms   ratio {mine / other:5.2f}"
    print(text)


def brusselator() -> None:
    """n = 2: Hopf point at B = 1 + A^2, period 2 pi / A."""
    model = Model(
        "bru2", states={"x": 1, "y": 1.5}, parameters={"B": 1.5, "A": 1},
        equations={"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
    )  # fmt: skip
    family = "NDIM=2\nNMX=300\nDS=0.01\nDSMAX=0.02\nTHL={11: 0.0}\n"
    auto = auto_orbits("bru2", "NDIM=2\nNMX=200\nDS=0.02\nDSMAX=0.05\n", family)
    compare("Brusselator, n = 2", model, "B", (1.5, 5), 0.004, 300, 50, (2.0, 2 * pi), auto)


def lorenz() -> None:
    """n = 3: Hopf point at rho = s (s + b + 3) / (s - b - 1), omega^2 = b (rho + s)."""
    b, s = 8 / 3, 10.0
    rho = s * (s + b + 3) / (s - b - 1)
    model = Model(
        "lor3", states={"x": "sqrt(b*(rho - 1))", "y": "sqrt(b*(rho - 1))", "z": "rho - 1"},
        parameters={"rho": 20, "b": "8/3", "s": 10},
        equations={"x": "s*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - b*z"},
    )  # fmt: skip
    auto = auto_orbits(
        "lor3", "NDIM=3\nNMX=300\nMXBF=-1\nDS=0.1\nDSMAX=0.5\nUZSTOP={1: 26.0}\n",
        "NDIM=3\nNMX=300\nDS=-0.05\nDSMAX=0.1\nTHL={11: 0.0}\n",
    )  # fmt: skip
    compare("Lorenz, n = 3", model, "rho", (20, 26), 0.004, 300, 50, (rho, 2 * pi / sqrt(b * (rho + s))), auto)


def coupled() -> None:
    """n = 4: two coupled Brusselators, whose homogeneous state has the Hopf point of one."""
    model = Model(
        "cbr4", states={"x": 1, "y": 1.5, "u": 1, "v": 1.5}, parameters={"B": 1.5, "A": 1, "D": 0.5},
        equations={
            "x": "A - (B + 1)*x + x^2*y + D*(u - x)", "y": "B*x - x^2*y + D*(v - y)",
            "u": "A - (B + 1)*u + u^2*v + D*(x - u)", "v": "B*u - u^2*v + D*(y - v)",
        },
    )  # fmt: skip
    family = "NDIM=4\nNMX=300\nDS=0.01\nDSMAX=0.02\nTHL={11: 0.0}\n"
    auto = auto_orbits("cbr4", "NDIM=4\nNMX=200\nDS=0.02\nDSMAX=0.05\n", family)
    compare("Two Brusselators, n = 4", model, "B", (1.5, 5), 0.004, 300, 50, (2.0, 2 * pi), auto)


def diffusive(n: int) -> None:
    """The Brusselator with diffusion on a line, n / 2 points; the first Hopf point has one half-wave."""
    m, a, b, dx, dy = n // 2, 2.0, 5.45, 0.008, 0.004
    equations = {}
    for i in range(m):
        left = (f"x{i - 1}", f"y{i - 1}") if i else ("A", "B/A")
        right = (f"x{i + 1}", f"y{i + 1}") if i < m - 1 else ("A", "B/A")
        reaction = f"x{i}^2*y{i}"
        c = f"{(m + 1) ** 2}/L^2"
        equations[f"x{i}"] = f"{reaction} - (B + 1)*x{i} + A + Dx*{c}*({left[0]} - 2*x{i} + {right[0]})"
        equations[f"y{i}"] = f"B*x{i} - {reaction} + Dy*{c}*({left[1]} - 2*y{i} + {right[1]})"
    states = {**{f"x{i}": a for i in range(m)}, **{f"y{i}": b / a for i in range(m)}}
    parameters = {"L": 0.4, "A": a, "B": b, "Dx": dx, "Dy": dy}
    model = Model(f"brx{n}", states=states, parameters=parameters, equations=equations)
    # the mode's eigenvalue of the second difference is -k; trace b - 1 - a^2 - (dx + dy) k = 0
    k = (b - 1 - a * a) / (dx + dy)
    length = 2 * (m + 1) * sin(pi / (2 * (m + 1))) / sqrt(k)
    omega = sqrt((b - 1 - dx * k) * (-a * a - dy * k) + a * a * b)
    auto = auto_orbits(
        "brx", f"NDIM={n}\nNTST=20\nNMX=40\nDS=0.02\nDSMAX=0.05\nUZSTOP={{1: 0.8}}\n",
        f"NDIM={n}\nNTST=20\nNMX=30\nDS=0.02\nDSMAX=0.1\nTHL={{11: 0.0}}\n",
    )  # fmt: skip
    compare(f"Brusselator on a line, n = {n}", model, "L", (0.4, 1.5), 0.02, 30, 20, (length, 2 * pi / omega), auto)


if __name__ == "__main__":
    brusselator()
    lorenz()
    coupled()
    for size in (10, 20, 40):
        diffusive(size)
