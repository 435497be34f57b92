"""The account of a branch: every change of the number of unstable eigenvalues is explained by the labels between."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.continuation.problem import Verified
from contin.special.table import special_type

ANY: Final = 1_000_000
BESIDE: Final = 3  # rows about a nonsmooth fold that the corrector may put on either of its arms
MET: Final = ("joined", "hopf", "homoclinic", "heteroclinic", "surface")  # ends whose last row is a special point


def _critical(code: str) -> int:
    """Most critical values of a point of this type; any number where the table names none."""
    known = special_type(code).critical
    return ANY if known is None else known


def moved(point: Verified) -> int:
    """How many eigenvalues (multipliers) may change sides at a labelled point."""
    if point.normal_form.get("kind") == "nonsmooth":
        return ANY
    return _critical(point.type) * int(point.vectors.get("kernel", 1)) + 2 * len(point.also)


def unexplained(
    unstable: NDArray[np.int64], labels: Iterable[tuple[int, Verified]], born: Iterable[int] = (),
    jumps: Iterable[int] = (),
) -> list[int]:  # fmt: skip
    """Rows before which `unstable` changes by more than the labels since the last unlabelled row explain.

    unstable (rows,) : critical values not counted at labelled rows.  labels : (row, point).  born : rows at special
    points of other branches, whose critical values are not counted either.  jumps : rows before which the equations are
    not smooth and any number of values changes.
    """
    allowed: dict[int, int] = dict.fromkeys(born, ANY)
    corners: set[int] = set()  # rows beside a corner of the equations: of either side, whatever their place
    for row, point in labels:
        allowed[row] = allowed.get(row, 0) + moved(point)
        if point.normal_form.get("kind") == "nonsmooth":
            corners.update(range(row - BESIDE, row + BESIDE + 1))
    for row in jumps:
        corners.update(range(row - BESIDE, row + BESIDE + 1))
    counted = np.ones(len(unstable), dtype=bool)
    counted[[row for row in allowed if 0 <= row < len(unstable)]] = False
    rows = np.flatnonzero(counted)
    changes = np.abs(np.diff(unstable[rows]))
    found = []
    for place in np.flatnonzero(changes).tolist():  # from one counted row to the next one
        first, row = int(rows[place]), int(rows[place + 1])
        slack = sum(allowed[between] for between in range(first + 1, row))
        if changes[place] > slack and row not in corners:
            found.append(row)
    return found
