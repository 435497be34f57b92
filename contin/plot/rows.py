"""What the page shows of a row of a branch besides its columns: spectra of all rows, orbits of some.

Branches in memory have both, and so have result files that keep them (`contin.continuation.kept_rows`).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.kept_rows import spaced_orbits
from contin.records import Fields, Record

MOST_VALUES: Final = 12  # of a spectrum: those nearest to instability
MOST_STATES: Final = 6
SAMPLES: Final = 160  # of an orbit
DIGITS: Final = 6


def rows_of(branches: Iterable[Branch]) -> dict[str, Fields]:
    """By branch: `spectrum` (rows of [re, im]) and `orbits` ({row, columns})."""
    return {branch.name: {"spectrum": _spectra(branch), "orbits": _orbits(branch)} for branch in branches}


def numbers(values: Array) -> list[float | None]:
    """With the digits of a picture; null where they are none."""
    return [float(f"{v:.{DIGITS}g}") if np.isfinite(v) else None for v in np.asarray(values, float).tolist()]


def leading(values: Array, multipliers: bool) -> list[list[float]]:
    """Those nearest to instability first, as pairs."""
    found = np.asarray(values, complex).ravel()
    found = found[np.isfinite(found)]
    order = np.argsort(-np.abs(found) if multipliers else -found.real, kind="stable")[:MOST_VALUES]
    return [[float(f"{v.real:.9g}"), float(f"{v.imag:.9g}")] for v in found[order]]


def _spectra(branch: Branch) -> list[list[list[float]]]:
    values = np.asarray(branch.eigenvalues)
    if values.ndim != 2 or not values.size:
        return []
    return [leading(row, branch.multiplier_kind) for row in values]


def _orbits(branch: Branch) -> list[Fields]:
    return [{"row": row, "columns": thinned(dict(orbit.columns))} for row, orbit in spaced_orbits(branch).items()]


def kept_in(document: Record) -> dict[str, Fields]:
    """The same of a result document: what it keeps of its branches; nothing of those of earlier files."""
    found = {}
    for branch in document["branches"]:
        rows = branch.get("rows", {})
        columns = [(one["row"], one["orbit"]) for one in rows.get("orbits", [])]
        columns += [(point["index"], point["orbit"]) for point in branch["points"] if "orbit" in point]
        multipliers = branch["kind"] in ("orbit", "fixed-point") or any("multipliers" in p for p in branch["points"])
        values = [[complex(*map(_number, pair)) for pair in row] for row in rows.get("eigenvalues", [])]
        found[branch["name"]] = {
            "spectrum": [leading(np.array(row, dtype=complex), multipliers) for row in values],
            "orbits": [{"row": row, "columns": thinned(dict(orbit))} for row, orbit in sorted(columns, key=_first)],
        }
    return found


def _first(pair: tuple[int, Record]) -> int:
    return pair[0]


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def thinned(columns: Fields) -> Fields:
    """`t` and the first states with no more samples than a small picture shows."""
    names = ["t", *[name for name in columns if name != "t"][:MOST_STATES]]
    count = len(columns["t"])
    chosen = np.unique(np.linspace(0, count - 1, min(SAMPLES, count)).round().astype(int))
    return {name: numbers(np.asarray(columns[name], float)[chosen]) for name in names if name in columns}
