"""Samples of a periodic orbit in a CSV file: where a run may begin that neither simulates nor leaves another branch."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Final

import numpy as np

from contin.abi import Array
from contin.model.source import Path, Problems
from contin.runs.outputs import path_mistake

LARGEST: Final = 1_000_000  # rows that are read
FEWEST: Final = 8  # samples that can tell a loop


@dataclass(frozen=True, eq=False)
class Samples:
    """times (K,) over one period, the last row the first again, and states (K, n) in the model's order."""

    times: Array
    states: Array


def read_samples(
    text: str, run_file: FilePath, names: Sequence[str], problems: Problems, place: Path
) -> Samples | None:
    """The columns `t` and `names` of a file with a header line, as `contin simulate --csv` writes it; no others.

    Returns None, with a note at `place`, where the file is not in or below the run file's folder, or is no such table.
    """
    folder = run_file.parent.resolve()
    mistake = path_mistake(text, (".csv",), folder, run_file)
    if mistake is None:
        table = _table(folder / text, ("t", *names))
        if not isinstance(table, str):
            return Samples(table[:, 0], table[:, 1:])
        mistake = f"{text!r} {table}"
    problems.add(place, mistake)
    return None


def _table(file: FilePath, columns: Sequence[str]) -> Array | str:
    """The columns of a file, (K, columns), or what is wrong with it."""
    try:
        with file.open(newline="", encoding="utf-8") as stream:
            reader = csv.reader(stream)
            header = [name.strip() for name in next(reader, [])]
            missing = [name for name in columns if name not in header]
            if missing:
                return f"has no column {missing[0]!r}; its first line must name t and the states, {','.join(columns)}"
            places = [header.index(name) for name in columns]
            rows: list[list[float]] = []
            for line in reader:
                if not line:
                    continue
                if len(rows) == LARGEST:
                    return f"has more than {LARGEST} lines; one period is enough"
                try:
                    rows.append([float(line[place]) for place in places])
                except (ValueError, IndexError):
                    return f"has no numbers in line {reader.line_num}: {','.join(line)[:60]!r}"
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        return f"cannot be read: {getattr(error, 'strerror', None) or error}"
    table = np.array(rows, dtype=float).reshape(-1, len(columns))
    if len(table) < FEWEST:
        return f"has {len(table)} samples; an orbit needs at least {FEWEST} over one period"
    if not np.isfinite(table).all() or not (np.diff(table[:, 0]) > 0.0).all():
        return "must have finite numbers, and times t that grow from line to line"
    return table
