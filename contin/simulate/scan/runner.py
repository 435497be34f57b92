"""One run of a scan: its start, until it has settled, and the name of what it settled on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from contin.abi import Array
from contin.errors import ContinError
from contin.model.evaluate import evaluate
from contin.records import Fields
from contin.simulate.consistent import consistent_start
from contin.simulate.natural import natural_metric
from contin.simulate.scan.grid import NO_START, OTHER, Outcome, ScanSpec
from contin.simulate.steady import Criterion, named_statistics, settle
from contin.simulate.sweep import default_criterion, parameters_of
from contin.simulate.systems import autonomous


class Runner:
    """Carries out single runs; safe to use from several threads."""

    def __init__(self, spec: ScanSpec) -> None:
        self.spec = spec
        self.system = autonomous(spec.measured)
        if spec.model.kind == "flow":
            _ = self.system.pieces, self.system.observables  # compiled before threads ask for it
        self.criterion = self._criterion()

    def _criterion(self) -> Criterion:
        """As given; without a window that of the first run that has a start."""
        given = dict(self.spec.settle)
        if "window" in given:
            return Criterion(**given)
        for job in range(len(self.spec)):
            found = self._start(job)
            if found is not None:
                return replace(default_criterion(self.system, natural_metric(self.system, *found[:2])), **given)
        return Criterion(1.0, **given)

    def _start(self, job: int) -> tuple[Array, Array, Fields] | None:
        """u, p and the parameters' overrides of a run; None where a start's formula has no value there."""
        spec = self.spec
        values, number = spec.place(job)
        start = spec.starts[number]
        names = list(spec.model.state_names)
        given = dict(zip([name for name, _ in spec.axes], values, strict=True))
        states = {name: value for name, value in given.items() if name in names}
        chosen = {name: value for name, value in given.items() if name not in states}
        try:
            u, p = spec.model.start_point(start, {**spec.parameters, **chosen})
        except ContinError:  # the run's outcome says that its start has no value
            return None
        for name, value in states.items():
            u[names.index(name)] = value
        try:
            u[:] = consistent_start(self.system, u, p)
        except ContinError:  # the run's outcome says so too
            return None
        return u, p, {**parameters_of(spec.model, start), **spec.parameters, **chosen}

    def run(self, job: int) -> Outcome:
        """Run number `job`, to its end."""
        spec, begun = self.spec, self._start(job)
        if begun is None:
            return Outcome(NO_START, NO_START, 0.0, {})
        u, p, overrides = begun
        found = settle(self.system, u, p, self.criterion)
        statistics = named_statistics(spec.quantities, found.statistics)
        if found.outcome not in ("settled", "unsettled"):
            return Outcome(found.outcome, found.outcome, found.time, statistics)
        env = {**spec.model.default_parameters(overrides), **statistics}
        label = next((name for name, node in spec.conditions.items() if evaluate(node, env)), OTHER)
        return Outcome(label, found.outcome, found.time, statistics)


_runners: dict[str, Runner] = {}


def run_batch(spec: ScanSpec, token: str, jobs: Sequence[int]) -> list[tuple[int, Outcome]]:
    """Several runs on a worker of a cluster, which keeps the compiled model of the last scan (`token` says which)."""
    runner = _runners.get(token)
    if runner is None:
        _runners.clear()
        runner = _runners[token] = Runner(spec)
    return [(job, runner.run(job)) for job in jobs]
