"""All runs of a scan: threads share them within a process, dask.distributed shares them between machines.

The runs are independent, and the kernels release the interpreter lock.
"""

from __future__ import annotations

import itertools
import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin import lazy
from contin.errors import InputError
from contin.model.kinds import need_model, need_time
from contin.records import Fields, Record
from contin.simulate.scan.grid import Outcome, ScanSpec, table
from contin.simulate.scan.runner import Runner, run_batch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.model.model import Model

BATCH: Final = 16  # runs that a worker of a cluster is given at once
SEED: Final = 0  # of the order of the runs


@dataclass(frozen=True, eq=False, repr=False)
class Scan:
    """A scan's runs: {number: outcome}."""

    spec: ScanSpec
    rows: Mapping[int, Outcome]

    @property
    def columns(self) -> dict[str, list[Any]]:
        """A table, a row a run: axes, start, class, outcome, time, statistics."""
        return table(self.spec.head(), self.rows)

    @property
    def document(self) -> Fields:
        """Everything, as data for JSON and for `contin.plot.scan.figure`."""
        return document_of(self.spec, self.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How many runs of each class, the most frequent first."""
        return dict(Counter(outcome.label for outcome in self.rows.values()).most_common())

    def plot(
        self, x: str | None = None, y: str | None = None, *, start: str | None = None, ax: Axes | None = None,
        **options: object,
    ) -> Figure:  # fmt: skip
        """A matplotlib figure: classes over one or two axes, a panel a start.

        start : draw this one alone.  ax : draw it into these axes instead.
        options : limits, log, size, legend, title, style (`contin.draw`).
        """
        chosen = {"x": x, "y": y, "start": start, **options}
        drawn: Figure = lazy.module("drawn scans").drawn(self.document, ax, chosen)
        return drawn

    def __repr__(self) -> str:
        return f"<Scan over {', '.join(name for name, _ in self.spec.axes)}: {len(self.rows)} runs>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook trajectories").scan_page(self))

    def __str__(self) -> str:
        return "\n".join([f"{len(self.rows)} runs", *(f"  {name}: {count}" for name, count in self.counts.items())])


def document_of(spec: ScanSpec, rows: Mapping[int, Outcome]) -> Fields:
    """Model, what was asked for, and the table, as data for JSON."""
    model = spec.model
    about = {
        "name": model.name,
        "title": model.title,
        "states": list(model.state_names),
        "parameters": model.default_parameters(spec.parameters),
    }
    return {"contin": 1, "model": about, "scan": spec.head(), "columns": table(spec.head(), rows)}


def scan(
    model: Model, axes: Mapping[str, Sequence[float]], *, starts: Sequence[Any] | Record = (None,),
    parameters: Record | None = None, measures: Mapping[str, str] | None = None,
    classes: Mapping[str, str] | None = None, settle: Record | None = None, threads: int | None = None,
    cluster: str | None = None, watch: Callable[[int, int], None] | None = None,
) -> Scan:  # fmt: skip
    """Simulate at every point of a grid over parameters or states, from each start, and name what is settled on.

    axes : {parameter or state: values}.  starts : the model's starts or mappings of states, or {name: one of these}.
    measures, classes, settle : see `contin.simulate.scan.grid.ScanSpec`.  threads, cluster, watch : see `carry_out`.
    """
    need_model(model)
    need_time(model, "runs in time to scan")
    grid = tuple((name, np.asarray(values, dtype=float)) for name, values in axes.items())
    chosen, names = (tuple(starts.values()), tuple(starts)) if isinstance(starts, Mapping) else (tuple(starts), ())
    spec = ScanSpec(model, grid, chosen, parameters or {}, measures or {}, classes or {}, settle or {}, names)
    return Scan(spec, carry_out(spec, threads=threads, cluster=cluster, watch=watch))


def carry_out(
    spec: ScanSpec, *, threads: int | None = None, cluster: str | None = None,
    known: Mapping[int, Outcome] | None = None, record: Callable[[int, Outcome], None] | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> dict[int, Outcome]:  # fmt: skip
    """All runs: {number: outcome}. In an order that mixes easy and hard ones, so that the time left can be told.

    threads : in this process (default: the processor's cores).  cluster : address of a dask.distributed scheduler
    (tcp://host:port); needs the extra `cluster`.  known : outcomes of an earlier, killed scan, not computed again.
    record : called with every new outcome as it arrives.  watch : called with (runs done, runs in all).
    """
    spec.check()
    rows = dict(known or {})
    jobs = [job for job in range(len(spec)) if job not in rows]
    random.Random(SEED).shuffle(jobs)
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


def _on_cluster(spec: ScanSpec, jobs: Sequence[int], address: str) -> Iterator[tuple[int, Outcome]]:
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("a scan on a cluster needs dask.distributed: pip install 'contin[cluster]'") from None
    from uuid import uuid4

    try:
        # never the process's default: dask would send unrelated work (xarray's files) to a client that never connected
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(f"--cluster {address}: no scheduler answers there ({error})") from None
    with client:
        token, everywhere = uuid4().hex, client.scatter(spec, broadcast=True)
        batches = [list(jobs[k : k + BATCH]) for k in range(0, len(jobs), BATCH)]
        futures = [client.submit(run_batch, everywhere, token, batch, pure=False) for batch in batches]
        for _, result in as_completed(futures, loop=client.loop, with_results=True):
            yield from result
