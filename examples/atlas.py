"""An atlas of a folder of models: what each one does, without a word from its author.

    python examples/atlas.py FOLDER [--out atlas.html] [--seconds 60] [--processes 2]

Every file that contin reads (.yaml, .ode, .xml, ...) is loaded, simulated, brought to an attractor (`start: auto`) and
surveyed: each parameter over [0.1, 10] times its value, to the first bifurcation. The page tells for each model its
states, conserved totals, attractors, bifurcations and time, or the reason why not; a .json beside it holds the same.
Each model runs in a process of its own, with a limit on its time: one that hangs or dies is a line like the others.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from datetime import date
from html import escape
from multiprocessing import get_all_start_methods, get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path

import contin
from contin.api.attractors import attractors
from contin.api.fixed_totals import for_branches
from contin.exchange.registry import endings
from contin.simulate.natural import natural_metric

STAGES = ("load", "simulate", "attractor", "survey")
OWN = (".yaml", ".yml")
TIMES = 100.0  # natural times that are simulated


def one(path: Path, most: int, tell=lambda found: None) -> dict[str, object]:
    """What becomes of one model: the last stage that it came to, and what was found on the way."""
    found: dict[str, object] = {"stage": "load", "seconds": {}}

    def timed(stage: str, work):
        found["stage"] = stage
        tell(dict(found))  # what is known when the time is up
        began = time.perf_counter()
        result = work()
        found["seconds"][stage] = time.perf_counter() - began
        return result

    try:
        model = timed("load", lambda: contin.load(str(path)))
        found |= {"name": model.name, "kind": getattr(model, "kind", "flow"), "states": len(model.state_names),
                  "parameters": len(model.parameter_names)}  # fmt: skip
        path_of = timed("simulate", lambda: simulated(model))
        found["simulated"] = path_of
        reduced = for_branches(model)
        found["totals"] = [t.name for t in getattr(reduced, "totals", ())]
        states = timed("attractor", lambda: attractors(model, most=most))
        found["attractors"] = [{"solution": str(a.solution), "how": a.how} for a in states.found]
        survey = timed("survey", lambda: contin.survey(model, most=most, processes=1))
        sides = [(r, s) for r in survey.rows for s in (r.below, r.above)]
        found["bifurcations"] = dict(Counter(s.type for _, s in sides if s.type))
        found["nearest"] = [f"{r.parameter} {r.margin:.3g}x" for r in survey.rows if r.margin < 1e9][:3]
        found["cut short"] = sum(not s.complete for _, s in sides)
        found["stage"] = "done"
    except Exception as error:  # noqa: BLE001  whatever it is, it is what the page is for
        found |= {"error": type(error).__name__, "reason": " ".join(str(error).split())[:600]}
    return found


def simulated(model) -> str:
    """How a trajectory over `TIMES` natural times went; a stiff method is tried where the first one fails."""
    if not model.state_names:
        return contin.simulate(model, time=1.0, samples=2).outcome
    time_of = 1.0
    with suppress(contin.ContinError):  # models with a clock of their own are only simulated
        if getattr(model, "kind", "flow") == "flow":
            system, (u, p) = contin.api.compiled(model), model.start_point()
            time_of = natural_metric(system, u, p).time
    words = ""
    for method, budget in (("DOP853", 200_000), ("LSODA", 1)):
        try:
            run = contin.simulate(model, time=TIMES * time_of, samples=50, method=method, budget=budget, rtol=1e-6)
        except contin.ContinError as error:
            words = str(error)
            continue
        if run.complete:
            return "done"
        words = run.why or run.outcome
    return words


def in_process(path: Path, most: int, send: Connection) -> None:
    """`one`, what is known so far sent whenever a stage begins."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # warnings of a hundred models
    send.send(one(path, most, send.send))


def all_of(files: list[Path], seconds: float, count: int, most: int) -> Iterator[dict[str, object]]:
    """Each model in a process of its own, `count` at a time; what is known when its time is up is its row."""
    context = get_context("fork" if "fork" in get_all_start_methods() else "spawn")
    waiting, running = list(files), []
    while waiting or running:
        while waiting and len(running) < count:
            path = waiting.pop(0)
            receive, send = context.Pipe(duplex=False)
            process = context.Process(target=in_process, args=(path, most, send), daemon=False)
            process.start()
            send.close()
            running.append((path, process, receive, time.monotonic(), {"stage": "load"}))
        wait([receive for _, _, receive, _, _ in running], timeout=0.5)
        left = []
        for path, process, receive, began, known in running:
            found, ended = drained(receive, known)
            late = time.monotonic() - began > seconds
            if not (ended or late):
                left.append((path, process, receive, began, found))
                continue
            if not ended:
                process.kill()
                found = found | {"error": "time", "reason": f"not finished in {seconds:g} s"}
            process.join()
            if process.exitcode and not late:
                found = found | {"error": "died", "reason": f"exit code {process.exitcode}"}
            yield {"file": path.name, "folder": path.parent.name, **found, "total": time.monotonic() - began}
        running = left


def drained(receive: Connection, known: dict[str, object]) -> tuple[dict[str, object], bool]:
    """The last message of a process, and whether it was its last."""
    try:
        while receive.poll():
            known = receive.recv()
    except EOFError:
        return known, True
    return known, "error" in known or known["stage"] == "done"


def kind_of(row: dict[str, object]) -> str:
    """The class of a failure: its stage and its words without names and numbers."""
    words = re.sub(r"^.*?:(\d+:)*\s", "", str(row.get("reason", "")))
    words = re.sub(r"'[^']*'|\"[^\"]*\"", "..", words)
    words = re.sub(r"[-+]?\d[\d.e+-]*", "#", words)
    return f"{row['stage']}: {' '.join(words.split()[:9])}"


def summary(rows: list[dict[str, object]]) -> dict[str, int]:
    """How many came how far."""
    return {
        "models": len(rows),
        "loaded": sum("states" in r for r in rows),
        "simulated": sum(r.get("simulated") == "done" for r in rows),
        "with conserved totals": sum(bool(r.get("totals")) for r in rows),
        "with an equilibrium or a cycle": sum(bool(r.get("attractors")) for r in rows),
        "surveyed": sum(r.get("stage") == "done" for r in rows),
        "with at least one bifurcation": sum(bool(r.get("bifurcations")) for r in rows),
    }


def page(rows: list[dict[str, object]]) -> str:
    """The atlas as HTML."""

    def cell(value: object) -> str:
        return f"<td>{escape(str(value))}</td>"

    lines = []
    for r in sorted(rows, key=lambda r: (r["folder"], r["file"])):
        states = "; ".join(f"{a['solution'][:120]} ({a['how']})" for a in r.get("attractors", ()))
        labels = ", ".join(f"{count} {code}" for code, count in dict(r.get("bifurcations", {})).items())
        outcome = "" if r["stage"] == "done" else f"{r['stage']}: {r.get('reason', '')}"
        nearest = ", ".join(r.get("nearest", ()))
        lines.append("<tr>" + "".join(cell(v) for v in (
            f"{r['folder']}/{r['file']}", r.get("kind", ""), r.get("states", ""), r.get("parameters", ""),
            ", ".join(r.get("totals", ())), states, labels, nearest, f"{r['total']:.1f}", outcome,
        )) + "</tr>")  # fmt: skip
    failed = Counter(kind_of(r) for r in rows if r["stage"] != "done")
    heads = ("model", "kind", "states", "parameters", "conserved", "attractors", "bifurcations met first", "nearest",
             "seconds", "why not")  # fmt: skip
    return f"""<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Atlas</title><style>
body {{ font: 14px sans-serif; margin: 2em }} table {{ border-collapse: collapse }}
td, th {{ border-bottom: 1px solid #ddd; padding: 3px 8px; text-align: left; vertical-align: top }}</style></head><body>
<h1>Atlas of {len(rows)} models</h1><p>contin {contin.__version__}, {date.today().isoformat()}</p>
<table>{"".join(f"<tr>{cell(k)}{cell(v)}</tr>" for k, v in summary(rows).items())}</table>
<h2>Why not</h2><table>{"".join(f"<tr>{cell(n)}{cell(k)}</tr>" for k, n in failed.most_common())}</table>
<h2>Models</h2><table><tr>{"".join(f"<th>{h}</th>" for h in heads)}</tr>{"".join(lines)}</table></body></html>
"""


def main() -> None:
    options = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    options.add_argument("folder", type=Path)
    options.add_argument("--out", type=Path, default=Path("atlas.html"))
    options.add_argument("--seconds", type=float, default=60.0, help="for each model")
    options.add_argument("--processes", type=int, default=2)
    options.add_argument("--attractors", type=int, default=2)
    given = options.parse_args()
    known = (*OWN, *endings())
    files = sorted(p for p in given.folder.rglob("*") if p.suffix.lower() in known)
    rows = []
    one(Path(__file__).parents[1] / "models" / "classics" / "brusselator.yaml", 1)  # kernels are there before all start
    for row in all_of(files, given.seconds, given.processes, given.attractors):
        rows.append(row)
        print(f"{len(rows)}/{len(files)} {row['file']}: {row['stage']} {row.get('reason', '')}"[:160], flush=True)
    given.out.with_suffix(".json").write_text(json.dumps(rows, indent=1))
    given.out.write_text(page(rows))
    for key, value in summary(rows).items():
        print(f"{value:6d} {key}")


if __name__ == "__main__":
    main()
