"""`contin check`: what is wrong with a run file or a model file, without computing anything."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from contin.errors import InputError

MODEL_KEYS: Final = frozenset({"states", "equations"})  # a run file has neither


def check_file(file: Path, execute: bool) -> int:
    """Check one file; with `execute`, carry out a model's `expect:` too. The exit code."""
    from contin.model.yaml_reader import read_file
    from contin.runs.bundled import find_run, is_scan

    file, place = find_run(file)
    document = read_file(file)
    if isinstance(document.data, dict) and MODEL_KEYS & document.data.keys() and "model" not in document.data:
        return check_model(file, execute)
    if execute:
        raise InputError(
            f"{file}: --run carries out the `expect:` of a model file; this is a run file (use `contin run`)"
        )
    if is_scan(file):
        from contin.runs.scan_plan import plan_scan

        spec = plan_scan(file, counts_as=place).spec
        print(f"{file}: good. Model {spec.model.name}, {len(spec.model.states)} states; a scan of {len(spec)} runs")
        return 0
    from contin.runs.load import read_run
    from contin.runs.plan import make_plan
    from contin.runs.simulation_plan import described

    plan = make_plan(read_run(document.data, document.source), document.source, place)
    runs = [run.name for run in plan.runs]
    phases = [f"phase diagram in {' and '.join(plan.phase.parameters)}"] if plan.phase else []
    what = ", ".join(
        ([f"diagram in {plan.diagram.parameter}"] if plan.diagram else [])
        + phases
        + runs
        + described(plan.simulations, plan.sweep)
    )
    print(f"{file}: good. Model {plan.model.name}, {len(plan.model.states)} states; runs: {what}")
    return 0


def check_model(file: Path, execute: bool) -> int:
    """Check a model file, and with `execute` that its expected points are found."""
    from contin.model.yaml_loader import load_model

    model = load_model(file)
    counts = f"{len(model.states)} states, {len(model.parameters)} parameters, {len(model.starts)} named starts"
    print(f"{file}: good. Model {model.name}: {counts}")
    if not execute:
        return 0
    from contin.runs.expect import verify_expectations

    failed = 0
    for report in verify_expectations(model):
        failed += not report.holds
        print(f"  {'holds' if report.holds else 'FAILS'}: {report.text}")
    return 1 if failed else 0
