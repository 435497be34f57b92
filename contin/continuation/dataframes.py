"""Branches as pandas data frames and xarray datasets; both libraries are optional (`pip install 'contin[frames]'`)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, Protocol

import numpy as np

from contin.abi import Array
from contin.errors import InputError


class Ended(Protocol):
    @property
    def text(self) -> str: ...


class Labelled(Protocol):
    @property
    def label(self) -> str: ...
    @property
    def index(self) -> int: ...
    @property
    def values(self) -> Mapping[str, float]: ...


class Tabular(Protocol):
    """What a table takes from a branch."""

    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def parameters(self) -> Sequence[str]: ...
    @property
    def columns(self) -> Mapping[str, Array]: ...
    @property
    def points(self) -> Sequence[Labelled]: ...
    @property
    def ends(self) -> Sequence[Ended]: ...
    def __len__(self) -> int: ...


def dataframe(branch: Tabular) -> Any:
    """A row for each row, a column for each column; `label` is the label of a labelled row, else ''."""
    return _library("pandas").DataFrame({"label": _labels(branch), **branch.columns})


def dataframes(branches: Sequence[Tabular]) -> Any:
    """All branches below each other, indexed by `branch` (its name) and `row`; what a branch lacks is missing (NaN)."""
    pandas = _library("pandas")
    if not branches:
        raise InputError("there is no branch")
    tables = {branch.name: dataframe(branch) for branch in branches}
    return pandas.concat(tables, names=["branch", "row"])


def dataset(branch: Tabular) -> Any:
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


def _labels(branch: Tabular) -> list[str]:
    labels = [""] * len(branch)
    for point in branch.points:
        labels[point.index] = point.label
    return labels


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise InputError(f"{name} is not installed: pip install 'contin[frames]'") from None
