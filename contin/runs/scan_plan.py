"""A scan file, its model and the command line -> a `ScanPlan`, checked before anything is computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath

import numpy as np

from contin.errors import ContinError, InputError
from contin.model.advice import closest
from contin.model.source import Path, Problems, Source
from contin.model.yaml_reader import read_file
from contin.records import Record
from contin.runs.load import read_entries
from contin.runs.outputs import ENDINGS, files_read, output_paths
from contin.runs.picture_entry import file_of, look_of
from contin.runs.plan import model_of
from contin.runs.planner import Planner
from contin.runs.scan_schema import AxisEntry, ScanFileEntry
from contin.simulate.scan.grid import ScanSpec


@dataclass(frozen=True, eq=False)
class ScanPlan:
    """What a scan file asks for."""

    spec: ScanSpec
    outputs: Mapping[str, FilePath] = field(default_factory=dict)
    title: str | None = None
    reads: Sequence[FilePath] = ()  # files that no output may overwrite
    look: Record = field(default_factory=dict)  # of the picture, as `contin.plot.look.Look.of` takes it


def plan_scan(
    path: FilePath, overrides: Record | None = None, counts_as: FilePath | None = None
) -> ScanPlan:
    """Read and check a scan file; InputError with every mistake at its place.

    counts_as : the file whose folder the outputs go to, where that is another (bundled files: the current folder).
    """
    document = read_file(path)
    path = counts_as or path
    source: Source = document.source
    if isinstance(document.data, dict) and "scan" not in document.data:
        raise InputError(f"{path}: this is no scan file: it has no `scan:` (a run file goes to `contin run`)")
    entry = read_entries(document.data, source, ScanFileEntry)
    problems = Problems(source)
    typed = dict(overrides or {})
    model = model_of(entry, source, path, problems, typed)  # type: ignore[arg-type]
    problems.raise_if_any()
    written = {
        "plot": file_of(entry.outputs.plot), "csv": entry.outputs.csv, "json": entry.outputs.json_,
        "save": entry.outputs.save,
    }  # fmt: skip
    wanted = {kind: name for kind, name in written.items() if name is not None}
    files = output_paths(wanted, path, problems, ENDINGS | {"save": (".scan",)})
    planner = Planner(model, problems, {**entry.parameters, **typed})
    planner.check_parameters(entry.parameters, typed)
    axes = []
    for name, axis in entry.scan.axes.items():
        place: Path = ("scan", "axes", name)
        if name not in (*model.parameter_names, *model.state_names):
            known = [*model.parameter_names, *model.state_names]
            advice = closest(name, known) or f"there are {', '.join(known)}"
            problems.add(place, f"{model.name} has neither a parameter nor a state {name!r}: {advice}", key=True)
            continue
        if isinstance(axis, AxisEntry):
            ends = planner.formula(axis.from_, (*place, "from")), planner.formula(axis.to, (*place, "to"))
            if ends[0] is not None and ends[1] is not None:
                axes.append((name, np.linspace(ends[0], ends[1], axis.points)))
        else:
            numbers = [planner.formula(value, (*place, k)) for k, value in enumerate(axis)]
            axes.append((name, np.array([number for number in numbers if number is not None])))
    written_starts = entry.scan.starts or []
    if isinstance(written_starts, Mapping):
        names, starts = (
            tuple(written_starts),
            [planner.start(start, ("scan", "starts", name)) for name, start in written_starts.items()],
        )
    else:
        names, starts = (), [planner.start(start, ("scan", "starts", k)) for k, start in enumerate(written_starts)]
    problems.raise_if_any()
    try:
        spec = ScanSpec(
            model, tuple(axes), tuple(starts) or (None,), planner.overrides, dict(entry.scan.measures),
            dict(entry.scan.classes), entry.scan.settle.model_dump(exclude_none=True), names,
        )  # fmt: skip
        spec.check()
    except ContinError as error:
        raise InputError(f"{path}: scan: {error}") from None
    return ScanPlan(spec, files, entry.title or model.title, files_read(entry, path), look_of(entry.outputs.plot))
