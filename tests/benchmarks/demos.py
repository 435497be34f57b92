"""contin beside AUTO-07p on AUTO's own demos, by hand: `python tests/benchmarks/demos.py [NAME ..]`.

Every run of `examples/auto/NAME.yaml` that both programs can do. AUTO gets the model's equations, the same start and
bounds, as many mesh intervals as contin takes, detection of everything, and of several longest steps
the one with which it is fastest among those with which it finds the same points. What it finds on the way is compared
(numbers of folds, branch points, Hopf points, doublings, tori), and whether it comes to its ends; where an end is no
bound (a Hopf point, a homoclinic orbit, a closed curve) it takes as many rows as contin. Times are processor times of
whole curves, without import and compilation, the smallest of a few runs.
"""

from __future__ import annotations

import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from beside import AUTO, CONSTANTS, as_constants
from equations import NPAR, boundary_counts, dimension, fortran, of_number, place, table, uses_time

from contin.continuation.branch import Branch, SpecialPoint
from contin.runs.engine import ContinEngine
from contin.runs.execute import execute
from contin.runs.load import load_run_file
from contin.runs.plan import make_plan
from contin.runs.plans import Plan, RunPlan

FOLDER = Path(__file__).parents[2] / "examples" / "auto"
RUNS = 3
TRIALS = 4
ENDED = (9, -4)  # AUTO's types of an end that it was asked for
LONG = 5.0  # seconds after which contin's run is not repeated
PERIOD = 11
CODES = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", 7: "PD", 8: "TR"}  # AUTO's types
OURS = {"LPC": "LP", "BPC": "BP", "NS": "TR"}  # the same in AUTO's words
COUNTED = ("LP", "BP", "HB", "PD", "TR")
KINDS = ("equilibrium", "algebraic", "fixed-point", "orbit", "bvp")
LEAST, MOST = 20, 200  # mesh intervals
STEPS = 4000
PARTS = 50  # of the range in AUTO's longest step, which its demos give themselves: here one rule for all
SPECIAL: dict[str, dict[str, Any]] = {}  # constants of one demo's run, where the rule will not do


class Timed(ContinEngine):
    """Processor time of every run."""

    def __init__(self) -> None:
        super().__init__()
        self.seconds: Counter[str] = Counter()

    def start(self, model: Any, run: RunPlan, parameters: Any) -> Any:
        began = time.process_time()
        found = super().start(model, run, parameters)
        self.seconds[run.name] += time.process_time() - began
        return found

    def start_at_point(self, branch: Branch, label: str, run: RunPlan) -> object:
        began = time.process_time()
        found = super().start_at_point(branch, label, run)
        self.seconds[run.name] += time.process_time() - began
        return found

    def continuation(self, start: object, run: RunPlan) -> Iterable[Branch]:
        began = time.process_time()
        found = list(super().continuation(start, run))
        self.seconds[run.name] += time.process_time() - began
        return found


@dataclass
class Found:
    """Of one curve of AUTO's: processor time, rows, numbers of special points, whether it came to its ends."""

    seconds: float = 0.0
    rows: int = 0
    points: Counter[str] = field(default_factory=Counter)
    whole: bool = True


@dataclass
class Curve:
    """One run of the file in AUTO: where its solutions are kept, for runs that start from them."""

    run: RunPlan
    branch: Branch
    parent: Curve | None
    folder: Path

    def label_near(self, point: SpecialPoint) -> str:
        """AUTO's label of a point: of its type, with the nearest value of the parameter."""
        type_ = OURS.get(point.type, point.type)
        value = point.values[self.branch.parameters[0]]
        near = [
            (abs(of_number(row[4]) - value), row[3])
            for row in rows_of(self.folder / "all.7")
            if (CODES.get(abs(int(row[2])) % 10) == type_ or (type_ == "UZ" and abs(int(row[2])) % 10 == 4))
        ]
        return min(near)[1]


def rows_of(path: Path) -> list[list[str]]:
    rows = [text.split() for text in path.read_text().splitlines()]
    return [row for row in rows if row and row[0] != "0"]


def own_constants(plan: Plan, run: RunPlan, branch: Branch) -> dict[str, Any]:
    """AUTO's constants for a run."""
    model, name = plan.model, run.parameters[0]
    low, high = run.range[name]
    index = place(model.parameter_names.index(name))
    ips = {"equilibrium": 1, "algebraic": 0, "fixed-point": -1, "orbit": 2, "bvp": 4}[branch.kind]
    free = [place(model.parameter_names.index(q)) for q in run.free]
    longest = (high - low) / PARTS
    constants = CONSTANTS | {
        "NDIM": dimension(model), "IPS": ips, "ICP": [index, *free], "NPAR": NPAR, "NMX": STEPS, "ISP": 2, "ILP": 1,
        "DS": longest / 10, "DSMIN": longest * 1e-6, "DSMAX": longest, "EPSS": 1e-5,
        "UZSTOP": {index: [low, high]}, "RL0": low - (high - low), "RL1": high + (high - low),
    }  # fmt: skip
    values = {place(model.parameter_names.index(n)): v for n, v in run.values.items() if n in model.parameter_names}
    constants["UZR"] = {k: list(v) for k, v in values.items()}
    if branch.kind in ("orbit", "bvp"):
        problem = branch.problem
        counts = [problem.profile(z).intervals for z in branch.z[:: max(1, len(branch) // 10)]]
        constants["NTST"] = int(np.clip(round(float(np.mean(counts))), LEAST, MOST))
    if branch.kind == "orbit":
        constants |= {"ICP": [index, *free, PERIOD], "THL": {PERIOD: 0.0}}
    if branch.kind == "bvp":
        constants["NBC"], constants["NINT"] = boundary_counts(model)
        constants["ISP"] = 2
    if any(end.reason not in ("bound", "start") for end in branch.ends):
        constants["NMX"] = max(10, round(branch.steps / len(arms(branch))))  # AUTO does not know that end
    return constants | SPECIAL.get(f"{model.name}.{run.name}", {})


def compiled(plan: Plan, run: RunPlan, branch: Branch, folder: Path) -> None:
    """The equations file with the start of a run, and its table where the start is a function."""
    model, row = plan.model, branch.start_row
    z = branch.z[row]
    known = {name: float(values[row]) for name, values in branch.columns.items() if name in model.parameter_names}
    base, u = model.start_point(run.start, plan.parameters)[1], np.zeros(dimension(model))
    values = dict(zip(model.parameter_names, map(float, base), strict=True)) | known
    if branch.kind in ("orbit", "bvp"):
        profile = branch.problem.profile(z)
        times, states = profile.times, [*profile.u.T[: len(model.states)]]
        if uses_time(model):
            first = float(branch.problem.two.model.interval.start.value)
            states.append(first + times)
        scale = profile.period if branch.kind == "orbit" else 1.0
        (folder / "model.dat").write_text(table(times * scale, states))
    else:
        u = np.array([float(branch.columns[name][row]) for name in model.state_names])
    (folder / "model.f90").write_text(fortran(model, u, values))
    objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
    command = ["gfortran", "-O2", "-fopenmp", "-w", "model.f90", "-o", "model", *objects]
    subprocess.run(command, check=True, cwd=folder)


def arms(branch: Branch) -> list[int]:
    """Signs of AUTO's first steps: one for every end that the curve runs to."""
    if branch.ends[0].reason != "start":
        return [-1, 1] if branch.ends[1].reason != "start" else [-1]
    turned = branch.columns[branch.parameters[0]]
    return [1 if turned[min(1, len(turned) - 1)] >= turned[0] else -1]


def followed(plan: Plan, curve: Curve) -> Found:
    """The run in AUTO: the fastest of several longest steps, of those with which it finds the same points and ends."""
    run, branch, folder = curve.run, curve.branch, curve.folder
    constants = own_constants(plan, run, branch)
    if curve.parent is None:
        compiled(plan, run, branch, folder)
        constants |= {"dat": "'model'"} if branch.kind in ("orbit", "bvp") else {}
    else:
        shutil.copy(curve.parent.folder / "model", folder / "model")
        shutil.copy(curve.parent.folder / "all.8", folder / "fort.3")
        assert run.reference is not None
        point = curve.parent.branch[run.reference[1]]
        constants["IRS"] = curve.parent.label_near(point)
        if point.type in ("BP", "BPC", "PD"):
            constants["ISW"] = -1
    longest, tried = constants["DSMAX"], []
    for _ in range(TRIALS):
        lengths = {"DS": min(constants["DS"], longest), "DSMAX": longest, "DSMIN": longest * 1e-6}
        found, texts = both_arms(branch, folder, constants | lengths)
        agrees = found.whole and found.points == counts(branch)
        tried.append((not agrees, not found.whole, found.seconds, constants | lengths, found))
        longest *= float(np.clip(found.rows / max(branch.steps, 1), 0.1, 10.0))
    *_, constants, found = min(tried, key=lambda each: each[:3])
    for _ in range(RUNS):
        again, texts = both_arms(branch, folder, constants)
        found.seconds = min(found.seconds, again.seconds)
    renumbered(folder, *texts)
    return found


def both_arms(branch: Branch, folder: Path, constants: dict[str, Any]) -> tuple[Found, tuple[list[str], list[str]]]:
    """One run for every end, and the texts of the rows and of the solutions."""
    once = Found()
    kept: tuple[list[str], list[str]] = ([], [])
    for sign in arms(branch):
        seconds, rows = executed(folder, constants | {"DS": sign * constants["DS"]})
        once.seconds += seconds
        once.rows += len(rows)
        once.points.update(CODES[k] for r in rows if (k := abs(int(r[2])) % 10) in CODES)
        once.whole &= bool(rows) and (int(rows[-1][2]) in ENDED and len(rows) < STEPS)
        for number, texts in zip((7, 8), kept, strict=True):
            path = folder / f"fort.{number}"
            texts.append(path.read_text() if path.exists() else "")
    return once, kept


def renumbered(folder: Path, tables: list[str], solutions: list[str]) -> None:
    """Both arms' rows and solutions in one file each; labels of the second arm follow those of the first."""
    rows, texts, shift = [], [], 0
    for rows_text, solution in zip(tables, solutions, strict=True):
        most = shift
        for line in rows_text.splitlines():
            parts = line.split()
            if parts and parts[0] != "0" and int(parts[3]):
                parts[3] = str(int(parts[3]) + shift)
                most = max(most, int(parts[3]))
            rows.append(" ".join(parts))
        lines = iter(solution.splitlines())
        for head in lines:
            parts = head.split()
            count = int(parts[8])
            parts[3] = str(int(parts[3]) + shift)
            texts.append(" ".join(parts))
            texts += [next(lines) for _ in range(count)]
        shift = most
    (folder / "all.7").write_text("\n".join(rows) + "\n")
    (folder / "all.8").write_text("\n".join(texts) + "\n")


def executed(folder: Path, constants: dict[str, Any]) -> tuple[float, list[list[str]]]:
    """Processor time of AUTO's process and its rows."""
    (folder / "fort.2").write_text(as_constants(constants))
    for number in (7, 8, 9):
        (folder / f"fort.{number}").unlink(missing_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {"OMP_NUM_THREADS": "1", "PATH": "/usr/bin:/bin"}
    subprocess.run([folder / "model"], cwd=folder, env=environment, check=False, capture_output=True, timeout=300)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    path = folder / "fort.7"
    rows = rows_of(path) if path.exists() else []
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, rows


def counts(branch: Branch) -> Counter[str]:
    types = [OURS.get(p.type, p.type) for p in branch.points]
    return Counter(t for t in types if t in COUNTED)


def compare(name: str) -> None:
    """Every run of the file that both can do; the sums last."""
    entry, source = load_run_file(FOLDER / f"{name}.yaml")
    plan = make_plan(entry, source, FOLDER / f"{name}.yaml")
    seconds: dict[str, float] = {}
    for _ in range(RUNS):
        engine = Timed()
        engine.prepare(plan.model)
        result = execute(plan, engine)
        seconds = {run: min(value, seconds.get(run, np.inf)) for run, value in engine.seconds.items()}
        if sum(seconds.values()) > LONG:
            break
    curves: dict[str, Curve] = {}
    sums = np.zeros(2)
    runs = {run.name: run for run in plan.runs}
    for branch in result.branches.values():
        run = runs.get(branch.name)
        if run is None or branch.image_of is not None or branch.name not in seconds:
            continue
        mine = seconds[branch.name]
        told = f"{name:5} {branch.name:11} contin {mine * 1e3:9.1f} ms {branch.steps:5} rows"
        parent = None if run.reference is None else curves.get(run.reference[0])
        alone = len(run.parameters) > 1 or plan.model.forcing or (run.reference and parent is None)
        if branch.kind not in KINDS or alone:
            print(told, flush=True)
            continue
        curve = Curve(run, branch, parent, Path(tempfile.mkdtemp()))
        try:
            found = followed(plan, curve)
        except (ValueError, subprocess.SubprocessError, FileNotFoundError) as error:
            print(f"{told}   AUTO: {error!r}"[:170], flush=True)
            continue
        curves[branch.name] = curve
        sums += (mine, found.seconds)
        told += f"   AUTO {found.seconds * 1e3:9.1f} ms {found.rows:5} rows   ratio {mine / found.seconds:6.2f}"
        if counts(branch) != found.points:
            told += f"   points {dict(counts(branch))} {dict(found.points)}"
        print(told if found.whole else f"{told}   AUTO stops", flush=True)
    if sums[1]:
        ours, theirs = sums * 1e3
        print(
            f"{name:5} in all      contin {ours:9.1f} ms   AUTO {theirs:9.1f} ms   ratio {ours / theirs:6.2f}",
            flush=True,
        )


if __name__ == "__main__":
    for each in sys.argv[1:] or sorted(path.stem for path in FOLDER.glob("*.yaml")):
        try:
            compare(each)
        except Exception as error:  # noqa: BLE001  the table goes on
            print(f"{each:5} {error!r}", flush=True)
