"""Result files of any kind by their ending: `.contin` (SQLite) and `.json`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from contin.errors import InputError
from contin.records import Fields, Record
from contin.store import json_format, sqlite
from contin.store.places import ending_of
from contin.store.tables import write_csv, write_netcdf

if TYPE_CHECKING:
    from contin.continuation.branch import Branch


def read_results(path: Path) -> Fields:
    """The result document in a file.

    Raises
    ------
    InputError
        The ending is neither `.contin` nor `.json`, or the file is not a contin result.
    """
    ending = ending_of(path)
    if ending == ".contin":
        return sqlite.load(path)
    if ending == ".json":
        return json_format.read(path)
    raise InputError(f"{path}: expected a result file that ends in .contin or .json")


def save_branches(branches: Iterable[Branch], path: str | Path, notes: Sequence[str] = ()) -> None:
    """Write branches in memory to a `.contin` (or `.json`) file."""
    branches = list(branches)
    total = sum(branch.seconds for branch in branches)
    document = json_format.result_document(
        json_format.model_of(branches), branches, timing={"total": total}, notes=[*notes]
    )
    export_results(document, Path(path))


def export_results(document: Record, path: Path) -> None:
    """Write a result document in the format that the file's ending names: `.json`, `.contin`, `.csv` or `.nc`."""
    writers = {".json": json_format.write, ".contin": sqlite.save, ".csv": write_csv, ".nc": write_netcdf}
    writer = writers.get(path.suffix)
    if writer is None:
        raise InputError(f"{path}: expected an ending of {', '.join(writers)}")
    writer(document, path)
