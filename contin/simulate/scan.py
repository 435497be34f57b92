"""Brute-force scans: a grid over parameters or initial states, several starts each, run to a steady state and named.

The runs are independent: threads share them within a process (the kernels release the interpreter lock), and an
existing engine, dask.distributed, shares them between machines.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import ContinError, ExpressionError, InputError
from contin.simulate.steady import STATISTICS, Criterion, named_statistics, settle, watching
from contin.simulate.sweep import parameters_of

LARGEST: Final = 10_000_000  # runs
OTHER: Final = "other"
NO_START: Final = "no start"
BATCH: Final = 16  # runs that a worker of a cluster is given at once


@dataclass(frozen=True, eq=False)
class ScanSpec:
    """What to run. Run number k stands for a point of the grid (axes in order, the last one fastest) and a start.

    axes : (name, values) of parameters or states.  starts : named starts, mappings of states, or None.
    measures : {name: formula} of the quantities watched.  classes : {name: condition} in the names QUANTITY_min,
    QUANTITY_mean, QUANTITY_max and the parameters; the first that holds names a run, `other` where none does.
    """

    model: Any
    axes: tuple[tuple[str, Array], ...]
    starts: tuple[Any, ...] = (None,)
    parameters: Mapping[str, Any] = field(default_factory=dict)
    measures: Mapping[str, str] = field(default_factory=dict)
    classes: Mapping[str, str] = field(default_factory=dict)
    criterion: Criterion = field(default_factory=lambda: Criterion(200.0))

    def __len__(self) -> int:
        return math.prod(len(values) for _, values in self.axes) * len(self.starts)

    def check(self) -> None:
        """Raises InputError or ExpressionError for formulas and names that cannot be carried out."""
        for name, values in self.axes:
            if name not in (*self.model.parameter_names, *self.model.state_names):
                raise InputError(f"{self.model.name} has neither a parameter nor a state {name!r}")
            if not len(values) or not np.all(np.isfinite(values)):
                raise InputError(f"the axis {name} needs finite values, one or more")
        if len(self) > LARGEST:
            raise InputError(f"{len(self)} runs are more than {LARGEST}")
        _ = self.conditions

    @cached_property
    def watched(self) -> Any:
        """The model with the measures as observables."""
        return watching(self.model, self.measures)

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        return tuple(self.watched.observables)

    @cached_property
    def conditions(self) -> dict[str, Any]:
        """The classes' conditions, parsed."""
        from contin.model.expression import symbol
        from contin.model.parser import parse_operand
        from contin.model.scope import Scope

        statistics = [f"{name}_{what}" for name in self.quantities for what in STATISTICS]
        names = {name: symbol(name) for name in (*self.model.parameter_names, *statistics)}
        parsed = {}
        for label, text in self.classes.items():
            try:
                operand = parse_operand(text, Scope(names, self.model.functions))
            except ExpressionError as error:
                raise ExpressionError(f"class {label!r}: {error} (known: {', '.join(statistics)})") from None
            if not operand.condition:
                raise InputError(f"class {label!r}: {text!r} is a number, not a condition; write, say, r1_max < 0.1")
            parsed[label] = operand.node
        return parsed

    def place(self, job: int) -> tuple[tuple[float, ...], int]:
        """The values on the axes, and the number of the start, of run `job`."""
        rest, start = divmod(job, len(self.starts))
        values = []
        for _, axis in reversed(self.axes):
            rest, k = divmod(rest, len(axis))
            values.append(float(axis[k]))
        return tuple(reversed(values)), start

    def start_name(self, number: int) -> str:
        start = self.starts[number]
        return start if isinstance(start, str) else "default" if start is None else f"start{number + 1}"

    def columns(self, rows: Mapping[int, Outcome]) -> dict[str, list[Any]]:
        """A table of the finished runs, in order: axes, start, class, outcome, time, statistics."""
        names = [f"{q}_{what}" for q in self.quantities for what in STATISTICS]
        columns: dict[str, list[Any]] = {name: [] for name, _ in self.axes}
        columns |= {key: [] for key in ("start", "class", "outcome", "time", *names)}
        for job in sorted(rows):
            values, start = self.place(job)
            outcome = rows[job]
            for (name, _), value in zip(self.axes, values, strict=True):
                columns[name].append(value)
            columns["start"].append(self.start_name(start))
            columns["class"].append(outcome.label)
            columns["outcome"].append(outcome.outcome)
            columns["time"].append(outcome.time)
            for name in names:
                columns[name].append(outcome.statistics.get(name, math.nan))
        return columns


@dataclass(frozen=True)
class Outcome:
    """What one run came to: its class, how it ended and when, the statistics of the last window."""

    label: str
    outcome: str
    time: float
    statistics: Mapping[str, float]


class Runner:
    """Carries out single runs; safe to use from several threads."""

    def __init__(self, spec: ScanSpec) -> None:
        from contin.lowering import compile_system

        self.spec = spec
        self.system = compile_system(spec.watched)
        if spec.model.kind == "flow":
            _ = self.system.pieces, self.system.observables  # compiled before threads ask for it

    def run(self, job: int) -> Outcome:
        """Run number `job`, to its end."""
        from contin.model.evaluate import evaluate

        spec = self.spec
        values, number = spec.place(job)
        start = spec.starts[number]
        given = dict(zip([name for name, _ in spec.axes], values, strict=True))
        states = {name: value for name, value in given.items() if name in spec.model.state_names}
        chosen = {name: value for name, value in given.items() if name not in states}
        overrides = {**parameters_of(spec.model, start), **spec.parameters, **chosen}
        try:
            u, p = spec.model.start_point(start, {**spec.parameters, **chosen})
        except ContinError:  # a start's formula has no value at these parameters
            return Outcome(NO_START, NO_START, 0.0, {})
        for name, value in states.items():
            u[list(spec.model.state_names).index(name)] = value
        found = settle(self.system, u, p, spec.criterion)
        statistics = named_statistics(spec.quantities, found.statistics)
        if found.outcome not in ("settled", "unsettled"):
            return Outcome(found.outcome, found.outcome, found.time, statistics)
        env = {**spec.model.default_parameters(overrides), **statistics}
        label = next((name for name, node in spec.conditions.items() if evaluate(node, env)), OTHER)
        return Outcome(label, found.outcome, found.time, statistics)


def scan(
    spec: ScanSpec, *, threads: int | None = None, cluster: str | None = None,
    known: Mapping[int, Outcome] | None = None, record: Callable[[int, Outcome], None] | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> dict[int, Outcome]:  # fmt: skip
    """All runs of a scan: {number: outcome}.

    threads : in this process (default: the processor's cores).  cluster : address of a dask.distributed scheduler
    (tcp://host:port); needs the extra `cluster`.  known : outcomes of an earlier, killed scan, not computed again.
    record : called with every new outcome as it arrives.  watch : called with (runs done, runs in all).
    """
    spec.check()
    rows = dict(known or {})
    jobs = [job for job in range(len(spec)) if job not in rows]
    finished = _on_cluster(spec, jobs, cluster) if cluster is not None else _in_threads(spec, jobs, threads)
    for job, outcome in finished:
        rows[job] = outcome
        if record is not None:
            record(job, outcome)
        if watch is not None:
            watch(len(rows), len(spec))
    return rows


def _in_threads(spec: ScanSpec, jobs: Sequence[int], threads: int | None) -> Iterator[tuple[int, Outcome]]:
    import os
    from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

    workers = threads or os.cpu_count() or 1
    if workers < 1:
        raise InputError(f"threads must be 1 or more; got {threads!r}")
    runner = Runner(spec)
    waiting: dict[Future[Outcome], int] = {}
    left = iter(jobs)
    with ThreadPoolExecutor(workers) as pool:
        try:
            for job in itertools.islice(left, 2 * workers):
                waiting[pool.submit(runner.run, job)] = job
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
                for job in itertools.islice(left, 2 * workers - len(waiting)):
                    waiting[pool.submit(runner.run, job)] = job
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


_runners: dict[str, Runner] = {}


def run_batch(spec: ScanSpec, token: str, jobs: Sequence[int]) -> list[tuple[int, Outcome]]:
    """Several runs on a worker of a cluster, which keeps the compiled model of the last scan (`token` says which)."""
    runner = _runners.get(token)
    if runner is None:
        _runners.clear()
        runner = _runners[token] = Runner(spec)
    return [(job, runner.run(job)) for job in jobs]


def _on_cluster(spec: ScanSpec, jobs: Sequence[int], address: str) -> Iterator[tuple[int, Outcome]]:
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("a scan on a cluster needs dask.distributed: pip install 'contin[cluster]'") from None
    from uuid import uuid4

    try:
        client = Client(address, timeout="10s")
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(f"--cluster {address}: no scheduler answers there ({error})") from None
    with client:
        token, everywhere = uuid4().hex, client.scatter(spec, broadcast=True)
        batches: Iterable[NDArray[np.int64]] = (
            np.array(jobs[k : k + BATCH], dtype=np.int64) for k in range(0, len(jobs), BATCH)
        )
        futures = [client.submit(run_batch, everywhere, token, batch.tolist(), pure=False) for batch in batches]
        for _, result in as_completed(futures, with_results=True):
            yield from result
