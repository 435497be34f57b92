"""A model's `expect:` carried out: in each run, the points of the type are exactly those expected."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from contin.model.evaluate import evaluate
from contin.model.source import CallSource, Problems
from contin.records import Fields, Record
from contin.runs.engine import ContinEngine, Engine
from contin.runs.execute import execute
from contin.runs.load import read_run
from contin.runs.plan import make_plan_for
from contin.runs.plans import Plan
from contin.runs.transforms import apply_passes

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.model.parts import Expectation


@dataclass(frozen=True)
class Report:
    """Whether an expectation holds, in words."""

    holds: bool
    text: str


def verify_expectations(model: Model, engine: Engine | None = None) -> Iterator[Report]:
    """Carry out every entry of the model's `expect:`."""
    for expectation in model.expect:
        yield verify(model, expectation, engine or ContinEngine())


def verify(model: Model, expectation: Expectation, engine: Engine) -> Report:
    """Carry out one expectation: the points of its type in its last run, against those expected, one to one."""
    plan = plan_of(model, expectation)
    result = execute(plan, engine)
    last = plan.runs[-1]
    wanted = [_numbers(point, plan) for point in expectation.at]
    branch = result.branches.get(last.name)
    if branch is None:
        return Report(False, f"{expectation.label} in {last.name}: {'; '.join(result.notes)}")
    found = [point.values for point in branch.points if point.type == expectation.label]
    left = list(found)
    missing = []
    for point in wanted:
        hit = next((candidate for candidate in left if _agrees(candidate, point, expectation.tolerance)), None)
        if hit is None:
            missing.append(point)
        else:
            left.remove(hit)
    names = list(wanted[0]) if wanted else list(last.parameters)
    what = f"{expectation.label} over {', '.join(last.parameters)}: {len(found)} found, {len(wanted)} expected"
    if missing or left:
        what += f"; missing {missing}" if missing else ""
        what += f"; unexpected {[{name: point.get(name) for name in names} for point in left]}" if left else ""
    return Report(not missing and not left, what)


def plan_of(model: Model, expectation: Expectation) -> Plan:
    """The runs of an expectation, written as in a run file, as a plan."""
    source = CallSource(f"expect {expectation.label} of {model.name}")
    runs: Sequence[Record] = expectation.runs or ({"parameter": model.parameter_names[0]},)
    problems = Problems(source)
    passed = apply_passes(model, expectation.transform, problems)
    problems.raise_if_any()
    written = [dict(run) for run in runs]
    parameters: Fields = {}
    for run in written:
        parameters.update(run.pop("parameters", {}))  # an expectation may set parameters beside its run
    data = {"model": model.name, "parameters": parameters, "continuations": written}
    entry = read_run(data, source, version_required=False)
    return make_plan_for(passed, entry, source, Path(model.name))


def _numbers(point: Record, plan: Plan) -> dict[str, float]:
    values = plan.model.default_parameters(plan.parameters)
    return {name: float(evaluate(expression, values)) for name, expression in point.items()}


def _agrees(found: Mapping[str, float], wanted: Mapping[str, float], tolerance: float) -> bool:
    return all(abs(found[name] - value) <= tolerance * max(1.0, abs(value)) for name, value in wanted.items())
