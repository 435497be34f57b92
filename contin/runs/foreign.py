"""A foreign model file in the place of a run file: what the file itself asks for, or a simulation."""

from __future__ import annotations

from pathlib import Path

from contin.exchange import registry
from contin.model.source import CallSource, Source
from contin.runs.load import read_run
from contin.runs.schema import RunEntry

is_foreign = registry.is_foreign


def foreign_run(file: Path) -> tuple[RunEntry, Source]:
    """The run that a foreign file asks for: its own ranges and times; a simulation where it asks for nothing."""
    source = CallSource(str(file))
    run = registry.read(file).run or {"simulate": [{"name": "simulation"}]}
    return read_run({**run, "model": str(file.absolute())}, source, version_required=False), source
