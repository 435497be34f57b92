"""Branches as pandas data frames and xarray datasets; both libraries are optional (`pip install 'contin[frames]'`)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.errors import InputError

if TYPE_CHECKING:
    from contin.continuation.branch import Branch


def dataframe(branch: Branch) -> Any:
    """A row for each row, a column for each column; `label` is the label of a labelled row, else ''."""
    return _library("pandas").DataFrame({"label": _labels(branch), **branch.columns})


def dataframes(branches: Sequence[Branch]) -> Any:
    """All branches below each other, indexed by `branch` (its name) and `row`; what a branch lacks is missing (NaN)."""
    pandas = _library("pandas")
    if not branches:
        raise InputError("there is no branch")
    tables = {branch.name: dataframe(branch) for branch in branches}
    return pandas.concat(tables, names=["branch", "row"])


def dataset(branch: Branch) -> Any:
    """The columns over the dimension `row`, with `label` as a coordinate; attributes say what the branch is."""
    columns = {name: ("row", np.asarray(column)) for name, column in branch.columns.items()}
    labels = ("row", np.array(_labels(branch), dtype=str))
    attributes = {
        "name": branch.name,
        "kind": branch.kind,
        "parameters": list(branch.parameters),
        "ends": [end.text for end in branch.ends],
        "points": json.dumps({point.label: dict(point.values) for point in branch.points}),
    }
    return _library("xarray").Dataset(columns, coords={"label": labels}, attrs=attributes)


def _labels(branch: Branch) -> list[str]:
    labels = [""] * len(branch)
    for point in branch.points:
        labels[point.index] = point.label
    return labels


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise InputError(f"{name} is not installed: pip install 'contin[frames]'") from None
