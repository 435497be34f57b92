"""What the page shows of a row of a branch besides its columns: spectra of all rows, orbits of some.

Branches in memory have both; a result file has them at its labelled points.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.errors import ContinError
from contin.records import Fields

MOST_VALUES: Final = 12  # of a spectrum: those nearest to instability
MOST_ORBITS: Final = 16  # of a branch, equally spaced in its rows, besides those at its labels
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
    if branch.kind != "orbit" or branch.problem is None:
        return []
    labelled = {int(point.index) for point in branch.points}
    spaced = np.linspace(0, len(branch) - 1, min(MOST_ORBITS, len(branch))).round().astype(int)
    found = []
    for row in sorted(labelled | set(spaced.tolist())):
        try:
            orbit = branch.orbit(row)
        except ContinError:  # fields, or an orbit without a profile: the page says at which row it shows one
            continue
        found.append({"row": row, "columns": thinned(dict(orbit.columns))})
    return found


def thinned(columns: Fields) -> Fields:
    """`t` and the first states with no more samples than a small picture shows."""
    names = ["t", *[name for name in columns if name != "t"][:MOST_STATES]]
    count = len(columns["t"])
    chosen = np.unique(np.linspace(0, count - 1, min(SAMPLES, count)).round().astype(int))
    return {name: numbers(np.asarray(columns[name], float)[chosen]) for name in names if name in columns}
