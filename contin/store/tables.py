"""Results as tables for spreadsheets and data frames: CSV (all branches in one table) and NetCDF (a group a branch)."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING

from contin.errors import InputError
from contin.records import Json, Record
from contin.store.atomic import replacing, write_text

if TYPE_CHECKING:
    from types import ModuleType


def write_csv(document: Record, path: Path) -> None:
    """One row for each row of each branch: `branch`, `label` (where the row is labelled), then every column."""
    names = list(dict.fromkeys(name for branch in document["branches"] for name in branch["columns"]))
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["branch", "label", *names])
    for branch in document["branches"]:
        labels = {point["index"]: point["label"] for point in branch["points"]}
        columns = [branch["columns"].get(name) for name in names]
        for row in range(len(next(iter(branch["columns"].values()), []))):
            cells = ["" if column is None else _cell(column[row]) for column in columns]
            writer.writerow([branch["name"], labels.get(row, ""), *cells])
    write_text(path, stream.getvalue())


def _cell(value: object) -> Json:
    return int(value) if isinstance(value, bool) else "" if value is None else repr(value)


def write_netcdf(document: Record, path: Path) -> None:
    """One NetCDF group for each branch, with its columns over the dimension `row`; needs the extra `frames`.

    A group's attributes say what the branch is; `points` and `ends` are JSON. The file appears whole or not at all.
    """
    try:
        import xarray
    except ImportError:
        raise InputError("NetCDF needs xarray: pip install 'contin[frames]'") from None
    with replacing(path) as temporary:
        try:
            root = {"contin": document["contin"], "model": json.dumps(document["model"]), "notes": document["notes"]}
            xarray.Dataset(attrs=root).to_netcdf(temporary, mode="w", engine="h5netcdf")
            for position, branch in enumerate(document["branches"]):
                group = f"branch{position}"
                _dataset(branch, xarray).to_netcdf(temporary, mode="a", group=group, engine="h5netcdf")
        except (ValueError, ImportError) as error:
            raise InputError(f"{path}: NetCDF cannot be written ({error}); pip install 'contin[frames]'") from None


def _dataset(branch: Record, xarray: ModuleType) -> Json:
    columns = {name: ("row", _filled(column)) for name, column in branch["columns"].items()}
    labels = [""] * len(next(iter(branch["columns"].values()), []))
    for point in branch["points"]:
        labels[point["index"]] = point["label"]
    attributes = {key: branch[key] for key in ("name", "kind", "parameters")}
    attributes |= {key: json.dumps(branch[key]) for key in ("points", "ends")}
    return xarray.Dataset({**columns, "label": ("row", labels)}, attrs=attributes)


def _filled(column: list[object]) -> list[Json]:
    nan = float("nan")
    return [nan if value is None else int(value) if isinstance(value, bool) else value for value in column]
